use std::collections::BTreeSet;

use super::super::{
    BlockPattern, Factorisation,
    ordering::{cheapest, minimum_degree},
};
use super::mixed;

/// Sum of the squared column lengths of the factor and its entries, by elimination of the scalar graph on paper.
fn by_elimination(pattern: &BlockPattern, cliques: &[Vec<u32>], order: &[u32]) -> (f64, usize) {
    let unknowns = |block: u32| pattern.first(block)..pattern.first(block) + pattern.size(block);
    let mut neighbours = vec![BTreeSet::new(); pattern.dimension()];
    let own: Vec<Vec<u32>> = (0..pattern.blocks() as u32).map(|block| vec![block]).collect();
    for clique in cliques.iter().chain(&own) {
        let all: Vec<usize> = clique.iter().flat_map(|&block| unknowns(block)).collect();
        for &k in &all {
            neighbours[k].extend(all.iter().copied().filter(|&other| other != k));
        }
    }
    let (mut flops, mut entries) = (0.0, 0);
    for k in order.iter().flat_map(|&block| unknowns(block)) {
        let later = std::mem::take(&mut neighbours[k]);
        flops += ((later.len() + 1) as f64).powi(2);
        entries += later.len() + 1;
        for &row in &later {
            neighbours[row].remove(&k);
            neighbours[row].extend(later.iter().copied().filter(|&other| other != row));
        }
    }
    (flops, entries)
}

#[test]
fn operations_are_those_of_elimination_and_what_merging_adds() {
    let (pattern, cliques) = mixed(70);
    for stride in [1, 3, 9] {
        let order: Vec<u32> = (0..70).map(|k| k * stride % 70).collect();
        let (flops, entries) = by_elimination(&pattern, &cliques, &order);
        assert_eq!(super::super::symbolic::elimination_flops(&pattern, &order), flops);
        let factorisation = Factorisation::in_order(&pattern, &order);
        assert!(factorisation.flops() >= flops && factorisation.stored() >= entries);
    }
}

#[test]
fn minimum_degree_makes_no_fill_in_a_tree() {
    // A chain numbered badly, and a star whose centre comes first.
    let chain: Vec<Vec<u32>> = (1..40_u32).map(|k| vec![(k - 1) * 7 % 40, k * 7 % 40]).collect();
    let star: Vec<Vec<u32>> = (1..40).map(|k| vec![0, k]).collect();
    for cliques in [chain, star] {
        let pattern = BlockPattern::new(&[1; 40], cliques.iter().map(Vec::as_slice));
        let natural: Vec<u32> = (0..40).collect();
        let order = minimum_degree(&pattern, &natural);
        assert_eq!(by_elimination(&pattern, &cliques, &order), (39.0 * 4.0 + 1.0, 79));
    }
}

#[test]
fn the_cheapest_order_costs_no_more_than_any_candidate() {
    let (pattern, cliques) = mixed(60);
    let cost = |order: &[u32]| by_elimination(&pattern, &cliques, order).0;
    let natural: Vec<u32> = (0..60).collect();
    let poor: Vec<u32> = (0..60).map(|k| k * 7 % 60).collect();
    let alone = cost(&cheapest(&pattern, &[]));
    assert!(alone <= cost(&minimum_degree(&pattern, &natural)));
    assert!(cost(&poor) > alone);
    assert!(cost(&cheapest(&pattern, &[&poor])) <= alone);
}

#[test]
fn a_given_order_is_taken_where_minimum_degree_is_worse() {
    let at = |x: u32, y: u32| 12 * y + x;
    let grid: Vec<Vec<u32>> = (0..11)
        .flat_map(|y| (0..11).map(move |x| vec![at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)]))
        .collect();
    let pattern = BlockPattern::new(&[1; 144], grid.iter().map(Vec::as_slice));
    let cost = |order: &[u32]| by_elimination(&pattern, &grid, order).0;
    let best = [5, 7, 11, 13, 17, 19, 23, 25, 29, 31, 35]
        .map(|stride| minimum_degree(&pattern, &(0..144).map(|k| k * stride % 144).collect::<Vec<u32>>()))
        .into_iter()
        .min_by(|a, b| cost(a).total_cmp(&cost(b)))
        .unwrap();
    assert!(cost(&best) < cost(&cheapest(&pattern, &[])));
    assert!(cost(&cheapest(&pattern, &[&best])) <= cost(&best));
}

#[test]
#[should_panic(expected = "twice in the order of elimination")]
fn an_order_has_each_block_once() {
    let (pattern, _) = mixed(10);
    Factorisation::in_order(&pattern, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 0]);
}
