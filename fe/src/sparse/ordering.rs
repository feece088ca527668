use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::pattern::BlockPattern;
use super::symbolic::elimination_flops;

/// Order of elimination by approximate minimum degree on the graph of the blocks.
pub(super) fn minimum_degree(pattern: &BlockPattern) -> Vec<u32> {
    let blocks = pattern.blocks();
    let mut starts = vec![0u32];
    let mut rows = Vec::new();
    for column in 0..blocks as u32 {
        rows.extend(pattern.column(column).map(|block| block.row));
        starts.push(rows.len() as u32);
    }
    let graph = SymbolicSparseColMatRef::new_checked(blocks, blocks, &starts, None, &rows);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<u32>(blocks, rows.len()));
    let (mut order, mut inverse) = (vec![0; blocks], vec![0; blocks]);
    amd::order_maybe_unsorted(
        &mut order,
        &mut inverse,
        graph,
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .expect("the graph has fewer than 2^32 entries, as the pattern's values");
    order
}

/// Of minimum degree and the given orders the one whose elimination needs the fewest operations.
pub(super) fn cheapest(pattern: &BlockPattern, given: &[&[u32]]) -> Vec<u32> {
    let candidates = std::iter::once(minimum_degree(pattern)).chain(given.iter().map(|order| order.to_vec()));
    candidates
        .map(|order| (elimination_flops(pattern, &order), order))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, order)| order)
        .expect("there is at least the order of minimum degree")
}
