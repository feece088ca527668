use std::ops::Range;

/// Pattern of a symmetric matrix of blocks: which block rows each block column has on and below the diagonal.
///
/// The values of a matrix of this pattern are one flat slice: block column by block column, in each column by column,
/// in each the rows of its blocks from the diagonal block down. A diagonal block is stored whole so that all columns of
/// a block column are equally long, but of it only the lower triangle is read: its strict upper triangle may hold anything.
#[derive(Debug, Clone)]
pub(crate) struct BlockPattern {
    /// First scalar unknown of each block, and their number at the end.
    first: Vec<usize>,
    /// Where the block rows of each block column start in `rows`.
    columns: Vec<usize>,
    /// Block rows, ascending within a column, the diagonal block first.
    rows: Vec<u32>,
    /// Scalar rows above each block within its column.
    offsets: Vec<u32>,
    /// Where the values of each block column start, and their number at the end.
    values: Vec<usize>,
}

/// Where a block's values are: entry (i, j) is at `index(i, j)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    start: u32,
    row_stride: u32,
    column_stride: u32,
}

impl Place {
    /// Index into the values of the block's entry (row `i`, column `j`).
    #[inline]
    pub fn index(self, i: usize, j: usize) -> usize {
        self.start as usize + i * self.row_stride as usize + j * self.column_stride as usize
    }
}

/// A stored block: its place in the block matrix, and its values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub row: u32,
    /// Index of its first value.
    pub start: usize,
    /// Distance between its columns.
    pub stride: usize,
}

impl BlockPattern {
    /// Pattern in which the blocks of each clique are all coupled: a clique is an element's nodes. Every block has its
    /// diagonal, in a clique or not. A block may occur several times in a clique.
    ///
    /// # Panics
    /// If a size is not in 1..=6, a clique names a block that is not there, or there are 2^32 values or more.
    pub fn new<'a>(block_sizes: &[u8], cliques: impl Iterator<Item = &'a [u32]>) -> Self {
        assert!(block_sizes.iter().all(|size| (1..=6).contains(size)), "a block has 1 to 6 unknowns");
        let blocks = block_sizes.len();
        let first = running_sum(block_sizes.iter().map(|&size| usize::from(size)));

        let mut members = Vec::new();
        let mut clique_starts = vec![0];
        for clique in cliques {
            members.extend_from_slice(clique);
            clique_starts.push(members.len());
        }
        let mut counts = vec![0; blocks];
        for &block in &members {
            assert!((block as usize) < blocks, "clique names block {block} of {blocks}");
            counts[block as usize] += 1;
        }
        let of_block = running_sum(counts.iter().copied());
        let mut next = of_block.clone();
        let mut cliques_of = vec![0; members.len()];
        for (clique, range) in clique_starts.windows(2).enumerate() {
            for &block in &members[range[0]..range[1]] {
                cliques_of[next[block as usize]] = clique;
                next[block as usize] += 1;
            }
        }

        let (mut columns, mut rows, mut offsets, mut values) = (vec![0], Vec::new(), Vec::new(), vec![0]);
        let mut seen_by = vec![u32::MAX; blocks];
        for column in 0..blocks {
            let begin = rows.len();
            seen_by[column] = column as u32;
            rows.push(column as u32);
            for &clique in &cliques_of[of_block[column]..of_block[column + 1]] {
                for &row in &members[clique_starts[clique]..clique_starts[clique + 1]] {
                    if row as usize > column && seen_by[row as usize] != column as u32 {
                        seen_by[row as usize] = column as u32;
                        rows.push(row);
                    }
                }
            }
            rows[begin..].sort_unstable();
            let mut height = 0;
            for &row in &rows[begin..] {
                offsets.push(height as u32);
                height += usize::from(block_sizes[row as usize]);
            }
            columns.push(rows.len());
            values.push(values[column] + height * usize::from(block_sizes[column]));
        }
        assert!(u32::try_from(values[blocks]).is_ok(), "too many values for places of 32 bits");
        Self { first, columns, rows, offsets, values }
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.first.len() - 1
    }

    /// Scalar unknowns.
    pub fn dimension(&self) -> usize {
        self.first[self.blocks()]
    }

    /// First scalar unknown of a block.
    pub fn first(&self, block: u32) -> usize {
        self.first[block as usize]
    }

    /// Scalar unknowns of a block.
    pub fn size(&self, block: u32) -> usize {
        self.unknowns(block).len()
    }

    /// Stored values: lower triangle with whole diagonal blocks.
    pub fn len(&self) -> usize {
        self.values[self.blocks()]
    }

    /// Where the values of block (row `a`, column `b`) are; above the diagonal, those of its transpose.
    ///
    /// # Panics
    /// If no clique holds both.
    pub fn place(&self, a: u32, b: u32) -> Place {
        let (row, column) = (a.max(b), a.min(b));
        let range = self.columns[column as usize]..self.columns[column as usize + 1];
        let at = self.rows[range.clone()].binary_search(&row);
        let at = range.start + at.unwrap_or_else(|_| panic!("blocks {a} and {b} are in no clique"));
        let start = self.values[column as usize] as u32 + self.offsets[at];
        let stride = self.stride(column) as u32;
        let (row_stride, column_stride) = if a < b { (stride, 1) } else { (1, stride) };
        Place { start, row_stride, column_stride }
    }

    /// `result = K vector` for the symmetric matrix of these values.
    pub fn multiply_into(&self, values: &[f64], vector: &[f64], result: &mut [f64]) {
        assert_eq!(values.len(), self.len());
        assert_eq!(vector.len(), self.dimension());
        result.fill(0.0);
        for column in 0..self.blocks() as u32 {
            let unknowns = self.unknowns(column);
            for (j, unknown) in unknowns.clone().enumerate() {
                let mut sum =
                    values[self.values[column as usize] + j * self.stride(column) + j] * vector[unknown];
                for below in unknown + 1..unknowns.end {
                    let start = self.values[column as usize] + j * self.stride(column);
                    let value = values[start + below - unknowns.start];
                    result[below] += value * vector[unknown];
                    sum += value * vector[below];
                }
                for block in self.column(column).skip(1) {
                    let rows = self.unknowns(block.row);
                    let start = block.start + j * block.stride;
                    let entries = &values[start..start + rows.len()];
                    for ((&value, sum_row), &x) in
                        entries.iter().zip(&mut result[rows.clone()]).zip(&vector[rows])
                    {
                        *sum_row += value * vector[unknown];
                        sum += value * x;
                    }
                }
                result[unknown] += sum;
            }
        }
    }

    /// The scalar unknowns of a block.
    pub(crate) fn unknowns(&self, block: u32) -> Range<usize> {
        self.first[block as usize]..self.first[block as usize + 1]
    }

    /// The blocks of a block column, the diagonal one first, then downwards.
    pub(crate) fn column(&self, column: u32) -> impl Iterator<Item = Block> + '_ {
        let stride = self.stride(column);
        (self.columns[column as usize]..self.columns[column as usize + 1]).map(move |at| Block {
            row: self.rows[at],
            start: self.values[column as usize] + self.offsets[at] as usize,
            stride,
        })
    }

    /// Scalar rows of a block column.
    fn stride(&self, column: u32) -> usize {
        (self.values[column as usize + 1] - self.values[column as usize]) / self.size(column)
    }
}

/// 0, then the sum of the first, of the first two, ..., of all.
pub(crate) fn running_sum(terms: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut sum = 0;
    std::iter::once(0)
        .chain(terms.map(|term| {
            sum += term;
            sum
        }))
        .collect()
}
