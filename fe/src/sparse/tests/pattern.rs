use nalgebra::DVector;

use super::super::{BlockPattern, Place};
use super::{assemble, mixed, noise};

#[test]
fn places_are_distinct_and_transposed_above_the_diagonal() {
    let (pattern, cliques) = mixed(23);
    let mut owner = vec![None; pattern.len()];
    for clique in &cliques {
        for &a in clique {
            for &b in clique.iter().filter(|&&b| b <= a) {
                let (lower, upper): (Place, Place) = (pattern.place(a, b), pattern.place(b, a));
                for i in 0..pattern.size(a) {
                    for j in 0..pattern.size(b) {
                        let key = (pattern.first(a) + i, pattern.first(b) + j);
                        assert!(owner[lower.index(i, j)].is_none_or(|other| other == key));
                        owner[lower.index(i, j)] = Some(key);
                        if a != b {
                            assert_eq!(lower.index(i, j), upper.index(j, i));
                        }
                    }
                }
            }
        }
    }
    // A block that no clique holds keeps its diagonal.
    let unowned = owner.iter().filter(|owner| owner.is_none()).count();
    let lonely: usize = (0..23_u32)
        .filter(|block| !cliques.iter().flatten().any(|b| b == block))
        .map(|b| pattern.size(b).pow(2))
        .sum();
    assert!(lonely > 0);
    assert_eq!(unowned, lonely);
}

#[test]
fn product_is_that_of_the_dense_matrix() {
    let (pattern, cliques) = mixed(31);
    let (mut values, dense) = assemble(&pattern, &cliques, 7, 2.0);
    // The strict upper triangles of diagonal blocks are not read.
    for block in 0..pattern.blocks() as u32 {
        for j in 0..pattern.size(block) {
            for i in 0..j {
                values[pattern.place(block, block).index(i, j)] = f64::NAN;
            }
        }
    }
    let mut noise = noise(3);
    let vector = DVector::from_fn(pattern.dimension(), |_, _| noise());
    let mut product = vec![f64::NAN; pattern.dimension()];
    pattern.multiply_into(&values, vector.as_slice(), &mut product);
    let expected = dense * vector;
    for (found, expected) in product.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-13);
    }
}

#[test]
fn dimensions_follow_the_block_sizes() {
    let pattern = BlockPattern::new(&[3, 6, 1], [&[2_u32, 0][..]].into_iter());
    assert_eq!((pattern.blocks(), pattern.dimension()), (3, 10));
    assert_eq!([0, 1, 2].map(|block| pattern.first(block)), [0, 3, 9]);
    // Column 0: its own 3 rows and the one of block 2; column 1: 6; column 2: 1.
    assert_eq!(pattern.len(), 3 * 4 + 6 * 6 + 1);
}

#[test]
#[should_panic(expected = "blocks 0 and 1 are in no clique")]
fn no_place_for_blocks_that_are_not_coupled() {
    BlockPattern::new(&[3, 3, 3], [&[0_u32, 2][..]].into_iter()).place(0, 1);
}
