mod factorisation;
mod modes;
mod ordering;
mod pattern;
mod solid;
mod tube;

use nalgebra::DMatrix;

use super::BlockPattern;

/// Numbers between -1/2 and 1/2, the same at each call.
fn noise(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

/// A pattern of blocks of all sizes, each in two or three cliques or in none, and its cliques.
fn mixed(blocks: usize) -> (BlockPattern, Vec<Vec<u32>>) {
    let sizes: Vec<u8> = (0..blocks).map(|block| [3, 3, 1, 3, 2, 6, 3, 4][block % 8]).collect();
    let mut cliques: Vec<Vec<u32>> =
        (0..blocks as u32 - 3).step_by(2).map(|first| vec![first + 3, first, first + 1, first]).collect();
    cliques.pop();
    cliques.push(vec![0, blocks as u32 / 2, 1]);
    (BlockPattern::new(&sizes, cliques.iter().map(Vec::as_slice)), cliques)
}

/// A random symmetric matrix of each clique, `shift` on its diagonal, assembled by places and densely.
fn assemble(pattern: &BlockPattern, cliques: &[Vec<u32>], seed: u64, shift: f64) -> (Vec<f64>, DMatrix<f64>) {
    let mut noise = noise(seed);
    let mut values = vec![0.0; pattern.len()];
    let mut dense = DMatrix::zeros(pattern.dimension(), pattern.dimension());
    let mut add = |a: u32, b: u32, i: usize, j: usize, value: f64| {
        // Of a diagonal block both triangles are assembled, as an element would.
        values[pattern.place(a, b).index(i, j)] += value;
        let (row, column) = (pattern.first(a) + i, pattern.first(b) + j);
        dense[(row, column)] += value;
        if a != b {
            dense[(column, row)] += value;
        }
    };
    for clique in cliques {
        let mut clique = clique.clone();
        clique.sort_unstable();
        clique.dedup();
        // Unsorted on purpose: places above the diagonal are used too.
        clique.reverse();
        clique.rotate_left(1);
        for (p, &a) in clique.iter().enumerate() {
            for &b in &clique[..p] {
                for i in 0..pattern.size(a) {
                    for j in 0..pattern.size(b) {
                        add(a, b, i, j, noise());
                    }
                }
            }
            for i in 0..pattern.size(a) {
                for j in 0..i {
                    let value = noise();
                    add(a, a, i, j, value);
                    add(a, a, j, i, value);
                }
                add(a, a, i, i, noise());
            }
        }
    }
    for block in 0..pattern.blocks() as u32 {
        for i in 0..pattern.size(block) {
            add(block, block, i, i, shift);
        }
    }
    (values, dense)
}
