use std::ops::Range;

use super::pattern::{Block, BlockPattern};
use super::symbolic::Symbolic;

/// How the values of a matrix and the contributions of children come together in the fronts: everything that depends on
/// the structure alone, so that a factorisation only adds and multiplies.
///
/// A front has its pivots first, then the rows below. Its first `width` columns, the panel, are kept: they become the
/// factor. The rest, the contribution, waits for the parent on a stack.
#[derive(Debug)]
pub(super) struct Fronts {
    pub fronts: Vec<Front>,
    entries: Vec<Entry>,
    runs: Vec<Run>,
    /// Rows below the pivots of all fronts, as scalar positions in the order of elimination.
    pub rows: Vec<u32>,
    /// Children of all fronts.
    pub children: Vec<u32>,
    /// Caller's unknown at each scalar position.
    pub unknowns: Vec<u32>,
    /// Values of the factor.
    pub stored: usize,
    /// Values on the stack of contributions at its fullest.
    pub stack: usize,
}

/// The dense matrix in which a supernode is eliminated.
#[derive(Debug)]
pub(super) struct Front {
    /// Pivots.
    pub width: usize,
    /// Pivots and rows below.
    pub height: usize,
    /// Scalar position of the first pivot.
    pub first: usize,
    /// Where its panel is in the factor.
    pub panel: Range<usize>,
    /// Its rows below the pivots, in `Fronts::rows`.
    pub rows: Range<usize>,
    pub children: Range<usize>,
    /// Where its contribution is computed on the stack, above those of its children,
    pub top: usize,
    /// and where it then waits, in their place.
    pub base: usize,
    entries: Range<usize>,
    /// How its contribution lies in the parent's front.
    runs: Range<usize>,
}

/// A block of the matrix in a panel.
#[derive(Debug, Clone, Copy)]
struct Entry {
    source: u32,
    stride: u32,
    target: u32,
    rows: u8,
    columns: u8,
    transposed: bool,
}

/// Consecutive rows of a contribution that are consecutive in the parent's front.
#[derive(Debug, Clone, Copy)]
struct Run {
    from: u32,
    to: u32,
    len: u32,
}

impl Front {
    /// Rows below the pivots.
    pub fn below(&self) -> usize {
        self.height - self.width
    }
}

impl Fronts {
    pub fn new(pattern: &BlockPattern, symbolic: &Symbolic) -> Self {
        let count = symbolic.supernodes.len();
        let size = |at: u32| pattern.size(symbolic.order[at as usize]);
        let mut supernode_of = vec![0; pattern.blocks()];
        for (s, supernode) in symbolic.supernodes.iter().enumerate() {
            supernode_of[supernode.pivots.start as usize..supernode.pivots.end as usize].fill(s);
        }
        let mut blocks_of: Vec<Vec<(u32, Block)>> = vec![Vec::new(); count];
        for column in 0..pattern.blocks() as u32 {
            for block in pattern.column(column) {
                let earlier = symbolic.position[column as usize].min(symbolic.position[block.row as usize]);
                blocks_of[supernode_of[earlier as usize]].push((column, block));
            }
        }

        let mut this = Self {
            fronts: Vec::with_capacity(count),
            entries: Vec::new(),
            runs: Vec::new(),
            rows: Vec::new(),
            children: Vec::new(),
            unknowns: symbolic
                .order
                .iter()
                .flat_map(|&block| pattern.unknowns(block))
                .map(|k| k as u32)
                .collect(),
            stored: 0,
            stack: 0,
        };
        let mut position = Vec::with_capacity(pattern.blocks());
        let mut next = 0;
        for at in 0..pattern.blocks() as u32 {
            position.push(next);
            next += size(at);
        }

        let mut local = vec![0; pattern.blocks()];
        let mut waiting: Vec<u32> = Vec::new();
        let mut top = 0;
        for (s, supernode) in symbolic.supernodes.iter().enumerate() {
            let rows = &symbolic.rows[supernode.rows.clone()];
            let mut height = 0;
            for at in supernode.pivots.clone().chain(rows.iter().copied()) {
                local[at as usize] = height as u32;
                height += size(at);
            }
            let first_row = this.rows.len();
            for &at in rows {
                this.rows
                    .extend((position[at as usize]..position[at as usize] + size(at)).map(|row| row as u32));
            }
            let width = height - (this.rows.len() - first_row);
            assert!(
                u32::try_from(height * width).is_ok(),
                "a front of {height} rows and {width} pivots is too large"
            );

            let first_entry = this.entries.len();
            for (column, block) in std::mem::take(&mut blocks_of[s]) {
                let (i, j) = (symbolic.position[block.row as usize], symbolic.position[column as usize]);
                this.entries.push(Entry {
                    source: block.start as u32,
                    stride: block.stride as u32,
                    target: local[i.min(j) as usize] * height as u32 + local[i.max(j) as usize],
                    rows: pattern.size(block.row) as u8,
                    columns: pattern.size(column) as u8,
                    transposed: i < j,
                });
            }

            let first_child = this.children.len();
            this.children.extend(waiting.drain(waiting.len() - supernode.children..));
            let mut base = top;
            for &child in &this.children[first_child..] {
                let first_run = this.runs.len();
                let mut from = 0;
                for &at in &symbolic.rows[symbolic.supernodes[child as usize].rows.clone()] {
                    let (to, len) = (local[at as usize], size(at) as u32);
                    match this.runs[first_run..].last_mut() {
                        Some(run) if run.to + run.len == to => run.len += len,
                        _ => this.runs.push(Run { from, to, len }),
                    }
                    from += len;
                }
                let front = &mut this.fronts[child as usize];
                front.runs = first_run..this.runs.len();
                base = base.min(front.base);
            }

            let contribution = (height - width).pow(2);
            this.fronts.push(Front {
                width,
                height,
                first: position[supernode.pivots.start as usize],
                panel: this.stored..this.stored + height * width,
                rows: first_row..this.rows.len(),
                children: first_child..this.children.len(),
                top,
                base,
                entries: first_entry..this.entries.len(),
                runs: 0..0,
            });
            this.stored += height * width;
            this.stack = this.stack.max(top + contribution);
            top = base + contribution;
            waiting.push(s as u32);
        }
        this
    }

    /// Puts the matrix's entries into an empty panel.
    pub fn fill(&self, front: &Front, values: &[f64], panel: &mut [f64]) {
        for entry in &self.entries[front.entries.clone()] {
            let (rows, columns) = (usize::from(entry.rows), usize::from(entry.columns));
            if (rows, columns) == (3, 3) {
                // Nearly all blocks: known sizes save a fifth of this function's time.
                fill_node_pair(entry, values, panel, front.height);
                continue;
            }
            for j in 0..columns {
                let source = &values[entry.source as usize + j * entry.stride as usize..][..rows];
                let target = entry.target as usize;
                if entry.transposed {
                    for (i, &value) in source.iter().enumerate() {
                        panel[target + i * front.height + j] = value;
                    }
                } else {
                    panel[target + j * front.height..][..rows].copy_from_slice(source);
                }
            }
        }
    }

    /// Adds to those columns of the parent's front that `target` holds, from column and row `first` on and `height` rows
    /// long, the child's contribution. Both are lower triangles.
    pub fn extend_add(
        &self,
        child: &Front,
        contribution: &[f64],
        target: &mut [f64],
        first: usize,
        columns: Range<usize>,
        height: usize,
    ) {
        let runs = &self.runs[child.runs.clone()];
        for (r, run) in runs.iter().enumerate() {
            let (from, to, len) = (run.from as usize, run.to as usize, run.len as usize);
            let begin = columns.start.clamp(to, to + len) - to;
            let end = columns.end.clamp(to, to + len) - to;
            for j in begin..end {
                let source = &contribution[(from + j) * child.below()..(from + j + 1) * child.below()];
                let column = &mut target[(to + j - first) * height..(to + j - first + 1) * height];
                add(&mut column[to + j - first..to + len - first], &source[from + j..from + len]);
                for lower in &runs[r + 1..] {
                    let (from, to, len) =
                        (lower.from as usize, lower.to as usize - first, lower.len as usize);
                    add(&mut column[to..to + len], &source[from..from + len]);
                }
            }
        }
    }
}

#[inline]
fn fill_node_pair(entry: &Entry, values: &[f64], panel: &mut [f64], height: usize) {
    let (stride, target) = (entry.stride as usize, entry.target as usize);
    let source = &values[entry.source as usize..][..2 * stride + 3];
    let target = &mut panel[target..][..2 * height + 3];
    for j in 0..3 {
        for i in 0..3 {
            let value = source[j * stride + i];
            if entry.transposed {
                target[i * height + j] = value;
            } else {
                target[j * height + i] = value;
            }
        }
    }
}

#[inline]
fn add(target: &mut [f64], source: &[f64]) {
    for (sum, &term) in target.iter_mut().zip(source) {
        *sum += term;
    }
}
