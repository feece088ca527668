use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::pattern::BlockPattern;
use super::symbolic::{elimination_flops, inverse};

/// Times minimum degree is run again on the best order it has found.
const REPETITIONS: usize = 2;

/// Order of elimination by approximate minimum degree on the graph of the blocks. Among many blocks of equal degree it
/// takes them as the given numbering has them, which matters: on tubes up to a factor of two in operations.
pub(crate) fn minimum_degree(pattern: &BlockPattern, numbering: &[u32]) -> Vec<u32> {
    let blocks = pattern.blocks();
    let number = inverse(numbering);
    let mut starts = vec![0u32];
    let mut rows = Vec::new();
    // Of each pair either half will do: `amd` takes the sum with the transpose.
    for &column in numbering {
        let begin = rows.len();
        rows.extend(pattern.column(column).map(|block| number[block.row as usize]));
        rows[begin..].sort_unstable();
        starts.push(rows.len() as u32);
    }
    let graph = SymbolicSparseColMatRef::new_checked(blocks, blocks, &starts, None, &rows);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<u32>(blocks, rows.len()));
    let (mut order, mut position) = (vec![0; blocks], vec![0; blocks]);
    amd::order_maybe_unsorted(
        &mut order,
        &mut position,
        graph,
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .expect("the graph has fewer than 2^32 entries, as the pattern's values");
    order.iter().map(|&number| numbering[number as usize]).collect()
}

/// The order of elimination that needs the fewest operations of: the given ones; minimum degree from the pattern's
/// numbering and from the given ones, each forwards and backwards; minimum degree from the best so far.
pub(crate) fn cheapest(pattern: &BlockPattern, given: &[&[u32]]) -> Vec<u32> {
    let natural: Vec<u32> = (0..pattern.blocks() as u32).collect();
    let mut best = natural.clone();
    let mut fewest = f64::INFINITY;
    let mut consider = |order: Vec<u32>, best: &mut Vec<u32>| {
        let flops = elimination_flops(pattern, &order);
        let better = flops < fewest;
        if better {
            (fewest, *best) = (flops, order);
        }
        better
    };
    for numbering in std::iter::once(&natural[..]).chain(given.iter().copied()) {
        let backwards: Vec<u32> = numbering.iter().rev().copied().collect();
        consider(minimum_degree(pattern, numbering), &mut best);
        consider(minimum_degree(pattern, &backwards), &mut best);
    }
    for order in given {
        consider(order.to_vec(), &mut best);
    }
    for _ in 0..REPETITIONS {
        if !consider(minimum_degree(pattern, &best), &mut best) {
            break;
        }
    }
    best
}
