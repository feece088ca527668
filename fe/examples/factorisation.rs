//! Times the sparse factorisation on tubes of 27-node hexahedra beside faer's own, one thread, one after the other in
//! each round, so that both see the same load:
//!
//!     cargo run --release -p fe --example factorisation -- 12x58x1 24x120x1
//!
//! Elements around, along and through the wall; a rigid cap at one end, the other held.

use std::time::Instant;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Par, Side};

use sparse::{BlockPattern, Factorisation, lowest_modes};
use tube::Tube;

#[path = "../src/sparse/mod.rs"]
#[expect(dead_code, unused_imports, reason = "the times need a part of the room only")]
mod sparse;
#[path = "../src/sparse/tests/tube.rs"]
mod tube;

const ROUNDS: usize = 7;

fn main() {
    let meshes: Vec<String> = std::env::args().skip(1).collect();
    let default = ["12x58x1", "12x90x1", "24x120x1"].map(String::from).to_vec();
    for mesh in if meshes.is_empty() { default } else { meshes } {
        let counts: Vec<usize> = mesh.split('x').filter_map(|count| count.parse().ok()).collect();
        let &[elements_around, elements_along, elements_through] = &counts[..] else {
            eprintln!("{mesh} is not a mesh: say AROUNDxALONGxTHROUGH, as 12x58x1");
            std::process::exit(2);
        };
        println!("{mesh}");
        time(&Tube {
            elements_around,
            elements_along,
            elements_through,
            inner_radius: 4.765e-3,
            outer_radius: 6.35e-3,
            length: 0.13,
            shear_modulus: 0.6e6,
            bulk_modulus: 6e9,
        });
    }
}

fn time(tube: &Tube) {
    let (analysed, pattern) = seconds(|| tube.pattern());
    println!("  unknowns {}, values {}, pattern {analysed:.3} s", pattern.dimension(), pattern.len());
    let values = tube.stiffness(&pattern);

    let along: Vec<u32> = (0..tube.blocks() as u32).collect();
    let dissected = dissect(tube);
    let plane = tube.plane();
    let planes = tube.blocks() / plane;
    let mut lines: Vec<u32> =
        (0..plane).flat_map(|line| (0..planes).map(move |k| (k * plane + line) as u32)).collect();
    lines.push(tube.blocks() as u32 - 1);
    let degree = sparse::ordering::minimum_degree(&pattern, &along);
    let orders = [("along the tube", &along), ("nested dissection", &dissected), ("minimum degree", &degree)];
    for (name, order) in orders {
        let one = Factorisation::in_order(&pattern, order);
        println!("  {name}: {:.2} Gflop, stored {:.1} M", one.flops() / 1e9, one.stored() as f64 / 1e6);
    }
    let (analysis, ours) = seconds(|| Factorisation::new(&pattern, &[]));
    println!(
        "  minimum degree, several: {:.2} Gflop, stored {:.1} M, analysis {analysis:.3} s",
        ours.flops() / 1e9,
        ours.stored() as f64 / 1e6
    );
    let (analysis, mut ours) = seconds(|| Factorisation::new(&pattern, &[&lines]));
    println!(
        "  taken: {:.2} Gflop, stored {:.1} M, analysis {analysis:.3} s",
        ours.flops() / 1e9,
        ours.stored() as f64 / 1e6
    );

    let mut theirs = Theirs::new(tube, &pattern, &values, &sparse::ordering::cheapest(&pattern, &[&lines]));
    println!("  faer in the same order: stored {:.1} M", theirs.factor.len() as f64 / 1e6);
    let mut times = [const { Vec::new() }; 3];
    for _ in 0..ROUNDS {
        times[0].push(seconds(|| ours.factorise(&values).expect("a held tube is stable")).0);
        times[1].push(seconds(|| theirs.factorise(false)).0);
        times[2].push(seconds(|| theirs.factorise(true)).0);
    }
    let ratio = |other: &[f64]| median(&other.iter().zip(&times[0]).map(|(b, a)| b / a).collect::<Vec<_>>());
    let best = |times: &[f64]| times.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "  factorise, median (best) {:.4} ({:.4}) s, at best {:.0} Gflop/s",
        median(&times[0]),
        best(&times[0]),
        ours.flops() / 1e9 / best(&times[0])
    );
    for (name, times) in [("LDLT", &times[1]), ("LLT", &times[2])] {
        println!(
            "  faer's {name} {:.4} ({:.4}) s, {:.2} times ours",
            median(times),
            best(times),
            ratio(times)
        );
    }

    let n = pattern.dimension();
    let right: Vec<f64> = (0..n).map(|k| (k as f64).sin()).collect();
    let mut solution = right.clone();
    let mut residual = vec![0.0; n];
    let solves: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            solution.copy_from_slice(&right);
            seconds(|| ours.solve(&mut solution)).0
        })
        .collect();
    let mut six = [&right[..]; 6].concat();
    ours.solve(&mut six.clone());
    let (six_sides, ()) = seconds(|| ours.solve(&mut six));
    pattern.multiply_into(&values, &solution, &mut residual);
    let left = residual.iter().zip(&right).fold(0.0_f64, |most, (kx, b)| most.max((b - kx).abs()));
    println!(
        "  solve {:.4} s, of six right-hand sides {six_sides:.4} s, residual {left:.1e}",
        median(&solves)
    );
    let (four, modes) = seconds(|| lowest_modes(&mut ours, 4, None));
    println!(
        "  four lowest modes {four:.3} s: {:.5?}",
        modes.iter().map(|mode| mode.value).collect::<Vec<_>>()
    );
}

/// Planes of nodes bisected by planes between elements, those last; then the pieces in minimum degree of their own.
fn dissect(tube: &Tube) -> Vec<u32> {
    fn recurse(tube: &Tube, planes: std::ops::Range<usize>, order: &mut Vec<u32>) {
        let blocks = |planes: std::ops::Range<usize>| {
            (planes.start * tube.plane()) as u32..(planes.end * tube.plane()) as u32
        };
        if planes.len() <= 8 {
            let inside = blocks(planes);
            let cliques: Vec<Vec<u32>> = tube
                .cliques()
                .iter()
                .map(|clique| {
                    clique
                        .iter()
                        .filter(|block| inside.contains(block))
                        .map(|block| block - inside.start)
                        .collect()
                })
                .collect();
            let piece = BlockPattern::new(&vec![3; inside.len()], cliques.iter().map(Vec::as_slice));
            let natural: Vec<u32> = (0..inside.len() as u32).collect();
            order.extend(
                sparse::ordering::minimum_degree(&piece, &natural).iter().map(|block| block + inside.start),
            );
            return;
        }
        // Free planes with odd numbers lie between elements.
        let middle = ((planes.start + planes.end) / 2) | 1;
        recurse(tube, planes.start..middle, order);
        recurse(tube, middle + 1..planes.end, order);
        order.extend(blocks(middle..middle + 1));
    }
    let mut order = Vec::new();
    recurse(tube, 0..2 * tube.elements_along - 1, &mut order);
    order.push(tube.blocks() as u32 - 1);
    order
}

/// faer's own sparse factorisation of the same matrix, its blocks in the order given.
struct Theirs {
    matrix: SparseColMat<u32, f64>,
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl Theirs {
    fn new(tube: &Tube, pattern: &BlockPattern, values: &[f64], blocks: &[u32]) -> Self {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for clique in tube.cliques() {
            pairs.extend(
                clique.iter().flat_map(|&a| clique.iter().map(move |&b| (a, b))).filter(|(a, b)| a >= b),
            );
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut entries = Vec::new();
        for (a, b) in pairs {
            let place = pattern.place(a, b);
            for i in 0..pattern.size(a) {
                for j in 0..pattern.size(b) {
                    let (row, column) = (pattern.first(a) + i, pattern.first(b) + j);
                    if row >= column {
                        entries.push(Triplet::new(row as u32, column as u32, values[place.index(i, j)]));
                    }
                }
            }
        }
        let n = pattern.dimension();
        let matrix = SparseColMat::try_new_from_triplets(n, n, &entries).expect("entries are in range");
        let order: Vec<u32> = blocks
            .iter()
            .flat_map(|&block| (0..pattern.size(block)).map(move |i| (pattern.first(block) + i) as u32))
            .collect();
        let mut inverse = vec![0; n];
        for (at, &unknown) in order.iter().enumerate() {
            inverse[unknown as usize] = at as u32;
        }
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let ordering = SymmetricOrdering::Custom(PermRef::new_checked(&order, &inverse, n));
        let symbolic = factorize_symbolic_cholesky(matrix.symbolic(), Side::Lower, ordering, parameters)
            .expect("the structure fits in memory");
        let memory = MemBuffer::new(StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default()),
        ]));
        Self { factor: vec![0.0; symbolic.len_val()], matrix, symbolic, memory }
    }

    fn factorise(&mut self, positive: bool) {
        let memory = MemStack::new(&mut self.memory);
        let (factor, matrix) = (&mut self.factor[..], self.matrix.as_ref());
        let (regular, parameters) = (Default::default(), Default::default());
        if positive {
            self.symbolic
                .factorize_numeric_llt(factor, matrix, Side::Lower, regular, Par::Seq, memory, parameters)
                .expect("a held tube is stable");
        } else {
            let (regular, parameters) = (Default::default(), Default::default());
            self.symbolic
                .factorize_numeric_ldlt(factor, matrix, Side::Lower, regular, Par::Seq, memory, parameters)
                .expect("a held tube is stable");
        }
    }
}

fn seconds<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

fn median(times: &[f64]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
