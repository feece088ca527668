use std::ops::Range;

use super::pattern::{BlockPattern, running_sum};

const NONE: u32 = u32::MAX;

/// A set of blocks eliminated together.
#[derive(Debug, Clone)]
pub(super) struct Supernode {
    /// Its blocks, as positions in the order of elimination.
    pub pivots: Range<u32>,
    /// Where its rows below the pivots are in `Symbolic::rows`.
    pub rows: Range<usize>,
    /// Scalar pivots.
    pub width: usize,
    /// Scalar rows, the pivots' included.
    pub height: usize,
    /// Supernodes that pass their contribution to this one: they precede it, the last one directly.
    pub children: usize,
}

/// Structure of the factor for an order of elimination.
#[derive(Debug)]
pub(super) struct Symbolic {
    /// Blocks in their order of elimination.
    pub order: Vec<u32>,
    /// Position of each block in that order.
    pub position: Vec<u32>,
    /// Supernodes, children before parents, each subtree together.
    pub supernodes: Vec<Supernode>,
    /// Rows below the pivots of all supernodes, as positions, ascending within a supernode.
    pub rows: Vec<u32>,
}

/// How eagerly supernodes are merged: a merged one of up to `width` scalar pivots may have this share of zeros.
pub(super) type Relaxation = [(usize, f64)];

/// The elimination tree of an order with the exact sizes of the factor's columns.
struct Elimination {
    /// Off-diagonal rows of the matrix below each position.
    below: Vec<u32>,
    below_starts: Vec<usize>,
    parent: Vec<u32>,
    /// Scalar rows of the factor's block column, its own included.
    heights: Vec<usize>,
}

impl Elimination {
    fn new(pattern: &BlockPattern, order: &[u32], position: &[u32]) -> Self {
        let blocks = pattern.blocks();
        let mut edges = Vec::new();
        let mut below_counts = vec![0; blocks];
        let mut above_counts = vec![0; blocks];
        for column in 0..blocks as u32 {
            for block in pattern.column(column).skip(1) {
                let (a, b) = (position[block.row as usize], position[column as usize]);
                let (low, high) = (a.min(b), a.max(b));
                below_counts[low as usize] += 1;
                above_counts[high as usize] += 1;
                edges.push((low, high));
            }
        }
        let below_starts = running_sum(below_counts.into_iter());
        let above_starts = running_sum(above_counts.into_iter());
        let (mut below, mut above) = (vec![0; edges.len()], vec![0; edges.len()]);
        let (mut next_below, mut next_above) = (below_starts.clone(), above_starts.clone());
        for (low, high) in edges {
            below[next_below[low as usize]] = high;
            next_below[low as usize] += 1;
            above[next_above[high as usize]] = low;
            next_above[high as usize] += 1;
        }

        // Liu's algorithm: the root of each subtree hanging below position k becomes its child.
        let mut parent = vec![NONE; blocks];
        let mut ancestor = vec![NONE; blocks];
        for k in 0..blocks {
            for &low in &above[above_starts[k]..above_starts[k + 1]] {
                let mut at = low;
                loop {
                    let up = std::mem::replace(&mut ancestor[at as usize], k as u32);
                    if up == k as u32 {
                        break;
                    }
                    if up == NONE {
                        parent[at as usize] = k as u32;
                        break;
                    }
                    at = up;
                }
            }
        }

        // Rows of a column: those of the matrix and of its children. A child's are dropped once passed on.
        let sizes: Vec<usize> = order.iter().map(|&block| pattern.size(block)).collect();
        let mut heights = vec![0; blocks];
        let mut structures: Vec<Vec<u32>> = vec![Vec::new(); blocks];
        let mut seen_by = vec![NONE; blocks];
        let (mut first_child, mut next_child) = (vec![NONE; blocks], vec![NONE; blocks]);
        for k in 0..blocks {
            seen_by[k] = k as u32;
            let mut height = sizes[k];
            let mut child = first_child[k];
            let mut rows = Vec::new();
            let mut add = |row: u32, rows: &mut Vec<u32>| {
                if seen_by[row as usize] != k as u32 {
                    seen_by[row as usize] = k as u32;
                    height += sizes[row as usize];
                    rows.push(row);
                }
            };
            while child != NONE {
                for row in std::mem::take(&mut structures[child as usize]) {
                    add(row, &mut rows);
                }
                child = next_child[child as usize];
            }
            for &row in &below[below_starts[k]..below_starts[k + 1]] {
                add(row, &mut rows);
            }
            heights[k] = height;
            structures[k] = rows;
            if parent[k] != NONE {
                let up = parent[k] as usize;
                next_child[k] = first_child[up];
                first_child[up] = k as u32;
            }
        }
        Self { below, below_starts, parent, heights }
    }
}

/// Multiplications and additions of an elimination without merging: sum of the squares of the factor's column lengths.
pub(super) fn elimination_flops(pattern: &BlockPattern, order: &[u32]) -> f64 {
    let tree = Elimination::new(pattern, order, &inverse(order));
    order.iter().zip(&tree.heights).map(|(&block, &height)| flops(pattern.size(block), height)).sum()
}

/// Sum of the squared lengths of `width` columns, the first of them `height` long.
fn flops(width: usize, height: usize) -> f64 {
    (0..width).map(|column| ((height - column) as f64).powi(2)).sum()
}

/// Values in `width` columns of a trapezoid, the first of them `height` long.
fn trapezoid(width: usize, height: usize) -> usize {
    width * height - width * (width - 1) / 2
}

/// Position of each block in an order.
///
/// # Panics
/// If the order is no permutation of the blocks.
pub(super) fn inverse(order: &[u32]) -> Vec<u32> {
    let mut position = vec![NONE; order.len()];
    for (k, &block) in order.iter().enumerate() {
        assert!(position[block as usize] == NONE, "block {block} is twice in the order of elimination");
        position[block as usize] = k as u32;
    }
    position
}

impl Symbolic {
    /// # Panics
    /// If `order` is no permutation of the blocks.
    pub fn new(pattern: &BlockPattern, order: &[u32], relaxation: &Relaxation) -> Self {
        assert_eq!(order.len(), pattern.blocks());
        let position = inverse(order);
        let blocks = order.len();
        let tree = Elimination::new(pattern, order, &position);

        // Merge each position's subtree into it where that adds few zeros: `leader` is the top of a supernode.
        let mut width: Vec<usize> = order.iter().map(|&block| pattern.size(block)).collect();
        let mut height = tree.heights.clone();
        let mut zeros = vec![0usize; blocks];
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); blocks];
        let mut merged: Vec<Vec<u32>> = vec![Vec::new(); blocks];
        for k in 0..blocks {
            let mut candidates = std::mem::take(&mut children[k]);
            // The longest first: it adds the fewest zeros for its width.
            candidates.sort_by_key(|&child| height[child as usize] - width[child as usize]);
            let mut kept = Vec::new();
            while let Some(child) = candidates.pop() {
                let c = child as usize;
                let new_zeros = width[c] * (height[k] + width[c] - height[c]);
                let total = zeros[k] + zeros[c] + new_zeros;
                let (w, h) = (width[k] + width[c], height[k] + width[c]);
                let share = total as f64 / trapezoid(w, h) as f64;
                if new_zeros == 0 || relaxation.iter().any(|&(limit, allowed)| w <= limit && share < allowed)
                {
                    (width[k], height[k], zeros[k]) = (w, h, total);
                    let below = std::mem::take(&mut merged[c]);
                    merged[k].extend(below);
                    merged[k].push(child);
                    candidates.append(&mut children[c]);
                } else {
                    kept.push(child);
                }
            }
            children[k] = kept;
            if tree.parent[k] != NONE {
                children[tree.parent[k] as usize].push(k as u32);
            }
        }

        let mut this =
            Self { order: Vec::with_capacity(blocks), position, supernodes: Vec::new(), rows: Vec::new() };
        let roots = (0..blocks as u32).filter(|&k| tree.parent[k as usize] == NONE);
        let postorder = postorder(roots, &mut children, &height, &width);
        for &leader in &postorder {
            let k = leader as usize;
            let begin = this.order.len() as u32;
            // Descendants before ancestors, which is ascending in the given order.
            merged[k].sort_unstable();
            merged[k].push(leader);
            this.order.extend(merged[k].iter().map(|&at| order[at as usize]));
            this.supernodes.push(Supernode {
                pivots: begin..this.order.len() as u32,
                rows: 0..0,
                width: width[k],
                height: height[k],
                children: children[k].len(),
            });
        }
        this.position = inverse(&this.order);
        this.find_rows(pattern, order, &tree, &postorder, &children, &merged);
        this
    }

    fn find_rows(
        &mut self,
        pattern: &BlockPattern,
        given: &[u32],
        tree: &Elimination,
        postorder: &[u32],
        children: &[Vec<u32>],
        merged: &[Vec<u32>],
    ) {
        let mut seen_by = vec![NONE; given.len()];
        let mut supernode_of = vec![0; given.len()];
        for (s, &leader) in postorder.iter().enumerate() {
            supernode_of[leader as usize] = s;
            let begin = self.rows.len();
            let end = self.supernodes[s].pivots.end;
            let mut add = |row: u32, rows: &mut Vec<u32>| {
                if row >= end && seen_by[row as usize] != s as u32 {
                    seen_by[row as usize] = s as u32;
                    rows.push(row);
                }
            };
            for &at in &merged[leader as usize] {
                let at = at as usize;
                for &row in &tree.below[tree.below_starts[at]..tree.below_starts[at + 1]] {
                    add(self.position[given[row as usize] as usize], &mut self.rows);
                }
            }
            for &child in &children[leader as usize] {
                for at in self.supernodes[supernode_of[child as usize]].rows.clone() {
                    add(self.rows[at], &mut self.rows);
                }
            }
            self.rows[begin..].sort_unstable();
            self.supernodes[s].rows = begin..self.rows.len();
            let below: usize =
                self.rows[begin..].iter().map(|&row| pattern.size(self.order[row as usize])).sum();
            assert_eq!(self.supernodes[s].width + below, self.supernodes[s].height, "rows of a supernode");
        }
    }

    /// Multiplications and additions of a factorisation, zeros of merged supernodes included.
    pub fn flops(&self) -> f64 {
        self.supernodes.iter().map(|supernode| flops(supernode.width, supernode.height)).sum()
    }
}

/// Children before parents; of the children first the one that needs most beyond what it leaves (Liu 1986), so that the
/// contributions that wait for their parent are few.
fn postorder(
    roots: impl Iterator<Item = u32>,
    children: &mut [Vec<u32>],
    height: &[usize],
    width: &[usize],
) -> Vec<u32> {
    let mut peak = vec![0usize; children.len()];
    let left = |k: u32| (height[k as usize] - width[k as usize]).pow(2);
    for k in 0..children.len() {
        // Children have smaller positions: their peaks are known.
        children[k].sort_by_key(|&child| std::cmp::Reverse(peak[child as usize] - left(child)));
        let mut waiting = 0;
        for &child in &children[k] {
            peak[k] = peak[k].max(waiting + peak[child as usize]);
            waiting += left(child);
        }
        peak[k] = peak[k].max(waiting + left(k as u32));
    }
    let mut order = Vec::new();
    let mut pending: Vec<(u32, bool)> = roots.map(|root| (root, false)).collect();
    pending.reverse();
    while let Some((k, ready)) = pending.pop() {
        if ready {
            order.push(k);
        } else {
            pending.push((k, true));
            pending.extend(children[k as usize].iter().rev().map(|&child| (child, false)));
        }
    }
    order
}
