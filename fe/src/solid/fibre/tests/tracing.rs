use super::*;
use crate::solid::{
    Coat,
    fibre::{surface::SurfacePoint, trace::Piece},
};

/// Total reference length of all fibres.
fn length(fibres: &Fibres, grid: &Grid) -> f64 {
    all_states(fibres, &grid.points).iter().map(|state| state.weight).sum()
}

/// Windings and meshes in which fibres lie in every way: along lines, across them with and against the hand, through corners.
fn cases() -> Vec<(Vec<Winding>, SolidMesh)> {
    use Handedness::{Left, Right};
    let graded = SolidMesh { under_fibre: 2, ..mesh(24, 24, true) };
    vec![
        (vec![winding(30.0, Right, 6, 0.0)], mesh(24, 24, true)),
        (vec![winding(30.0, Left, 6, 0.3e-3)], mesh(24, 24, true)),
        (vec![winding(30.0, Right, 6, 0.3e-3)], graded),
        (vec![winding(30.0, Right, 6, 0.3e-3)], mesh(24, 24, false)),
        (vec![winding(90.0, Left, 5, 0.3e-3)], mesh(24, 12, false)),
        (vec![winding(40.0, Right, 6, 0.3e-3), winding(40.0, Left, 6, 0.3e-3)], graded),
        (vec![winding(60.0, Left, 4, 0.0), winding(20.0, Right, 7, 2e-3)], mesh(24, 36, true)),
        (vec![winding(60.0, Left, 4, 20e-3)], mesh(24, 36, true)),
    ]
}

#[test]
fn pieces_join_into_the_helix() {
    for (windings, mesh) in cases() {
        let specimen = specimen(&windings);
        let grid = grid(&specimen, mesh);
        let around = Around::new(&grid);
        let radius = specimen.tube.outer_radius();
        for winding in &windings {
            for (index, strand) in (0..winding.fibres as usize).flat_map(|index| {
                strands(&grid, winding, radius, index).into_iter().map(move |strand| (index, strand))
            }) {
                let pieces = trace(&grid, LENGTH, strand);
                // Height and angle at an end of a piece, from its cell alone.
                let place = |piece: &Piece, end: usize| {
                    let [a, z] = piece.ends[end];
                    let [cell, plane] = piece.cell;
                    let (from, to) = (around.edge(cell), around.edge(cell + 1));
                    let height = LENGTH / grid.elements[2] as f64 * (plane as f64 + 0.5 * (z + 1.0));
                    let eta = from + 0.5 * (a + 1.0) * (to - from) + f64::from(piece.sector) * around.period;
                    [height, eta + grid.turn * height]
                };
                let mut last = [0.0, strand.start];
                for piece in &pieces {
                    assert!(piece.ends.iter().flatten().all(|x| x.abs() <= 1.0), "{piece:?}");
                    let (from, to) = (place(piece, 0), place(piece, 1));
                    assert!((from[0] - last[0]).abs() < 1e-9 * LENGTH, "{piece:?} after {last:?}");
                    assert!((from[1] - last[1]).abs() < 1e-8, "{piece:?} after {last:?}");
                    assert!(to[0] > from[0]);
                    last = to;
                }
                assert!((last[0] - LENGTH).abs() < 1e-12);
                let turn = winding.handedness.sign() * winding.turn_per_length(radius);
                let half = 0.5 * winding.fibre.diameter / (winding.angle_from_hoop().sin() * radius);
                let middle = TAU * index as f64 / f64::from(winding.fibres);
                let aside = last[1] - middle - turn * LENGTH;
                assert!(aside.abs() <= half + 1e-8, "fibre {index} ends {aside} rad aside");
            }
        }
    }
}

#[test]
fn length_is_that_of_helices_to_fourth_order() {
    let exact = |windings: &[Winding]| -> f64 {
        windings.iter().map(|w| f64::from(w.fibres) * LENGTH / w.angle_from_hoop().sin()).sum()
    };
    for (windings, mesh) in cases() {
        let specimen = specimen(&windings);
        let exact = exact(&windings);
        let errors = [1, 2, 4].map(|factor| {
            let (grid, fibres) = trusses(&specimen, mesh.refined(factor));
            (length(&fibres, &grid) / exact - 1.0).abs()
        });
        assert!(errors[0] < 2e-4, "{windings:?}: {errors:?}");
        // Below 1e-11 is rounding. Both steps together: where lines cross cells, each mesh cuts them differently.
        let order = 0.5 * (errors[0] / errors[2]).log2();
        assert!(errors[2] < 1e-11 || order > 3.8, "{order}: {errors:?}");
    }
}

#[test]
fn strands_share_the_stiffness_of_their_fibre() {
    for (windings, mesh) in cases() {
        let specimen = specimen(&windings);
        let grid = grid(&specimen, mesh);
        for winding in &windings {
            for index in 0..winding.fibres as usize {
                let strands = strands(&grid, winding, specimen.tube.outer_radius(), index);
                let middle = TAU * index as f64 / f64::from(winding.fibres);
                let total: f64 = strands.iter().map(|strand| strand.share).sum();
                let centre: f64 = strands.iter().map(|strand| strand.share * strand.start).sum();
                assert!((total - 1.0).abs() < 1e-12 && (centre - middle).abs() < 1e-12);
                // Second moment of an even spread.
                let spread: f64 =
                    strands.iter().map(|strand| strand.share * (strand.start - middle).powi(2)).sum();
                let half = (0.5 * winding.fibre.diameter)
                    / (winding.angle_from_hoop().sin() * specimen.tube.outer_radius());
                let half = half.min(0.5 * TAU / f64::from(winding.fibres));
                assert!((spread - half * half / 3.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn only_points_of_the_line_take_part_along_a_line() {
    for specimen in [
        specimen(&[winding(35.0, Handedness::Left, 6, 0.0)]),
        specimen(&[winding(90.0, Handedness::Right, 6, 0.0)]),
    ] {
        let (_, fibres) = trusses(&specimen, mesh(24, 10, true));
        assert_eq!(fibres.elements.len(), 60);
        assert!(fibres.elements.iter().all(|element| element.blocks().len() == 3));
    }
    // Five fibres on 20 straight elements around are on lines; three are in the middle of elements every other time.
    for (count, around) in [(5, 20), (3, 4)] {
        let specimen = specimen(&[winding(90.0, Handedness::Right, count, 0.0)]);
        let (_, fibres) = trusses(&specimen, mesh(around, 10, false));
        let on_lines = fibres.elements.iter().filter(|element| element.blocks().len() == 3).count();
        assert_eq!(
            (fibres.elements.len(), on_lines),
            (10 * count as usize, if count == 5 { 50 } else { 10 })
        );
    }
}

#[test]
fn sectors_make_the_whole() {
    for (windings, mesh) in cases().into_iter().filter(|(windings, _)| windings.len() == 1) {
        let specimen = specimen(&windings);
        let sectors = windings[0].fibres as usize;
        if mesh.around % sectors != 0 {
            continue;
        }
        let (whole, all) = trusses(&specimen, mesh);
        let sector = Grid::new(&specimen, mesh, sectors).unwrap();
        let one = Fibres::trusses(&specimen, &sector).unwrap();
        let difference = length(&one, &sector) * sectors as f64 / length(&all, &whole) - 1.0;
        assert!(difference.abs() < 1e-12, "{windings:?}: {difference}");
        let energy = |fibres: &Fibres, grid: &Grid| -> f64 {
            let positions = moved(grid, 1.1, -20.0, 1.05);
            fibres.elements.iter().map(|element| element.energy(&positions, &[]).unwrap()).sum()
        };
        let ratio = energy(&one, &sector) * sectors as f64 / energy(&all, &whole);
        assert!((ratio - 1.0).abs() < 1e-12, "{windings:?}: {ratio}");
    }
}

#[test]
fn impossible_families_are_refused() {
    let six = specimen(&[winding(30.0, Handedness::Right, 6, 0.0)]);
    let grid = Grid::new(&six, mesh(24, 8, false), 6).unwrap();
    for count in [4, 0] {
        let mut four = six.clone();
        four.windings[0].fibres = count;
        let refusal = Fibres::trusses(&four, &grid).unwrap_err();
        assert!(refusal.to_string().contains("number of fibres"), "{refusal}");
    }
    let mut shrunk = six.clone();
    shrunk.windings[0].fibre.diameter = -1e-4;
    assert!(Fibres::trusses(&shrunk, &grid).unwrap_err().to_string().contains("diameter"));
    let bare = specimen(&[]);
    assert!(trusses(&bare, mesh(24, 8, true)).1.elements.is_empty());
}

#[test]
fn fibres_lie_on_the_tube_under_a_coat_and_on_a_tapered_one() {
    let mut specimen = specimen(&[winding(30.0, Handedness::Right, 6, 0.3e-3)]);
    let elastomer = specimen.elastomer;
    specimen.coat = Some(Coat { thickness: 1e-3, elastomer });
    specimen.wall_taper = 1.5;
    specimen.bore_offset = [[2e-4, 0.0], [0.0, -3e-4]];
    let (grid, fibres) = trusses(&specimen, mesh(48, 24, false));
    for state in all_states(&fibres, &grid.points) {
        let [x, y, z] = state.position;
        let outer = 4.76e-3 + 0.8e-3 * (1.0 + 0.5 * z / LENGTH);
        assert!((x.hypot(y) / outer - 1.0).abs() < 1e-5);
        assert!((state.stretch - 1.0).abs() < 1e-12 && state.tension.abs() < 1e-9);
    }
}

#[test]
fn slopes_are_derivatives_of_values() {
    let piece = Piece { cell: [0, 0], ends: [[-0.7, -1.0], [0.4, 0.3]], sector: 0 };
    let step = 1e-5;
    let at = |share| SurfacePoint::new(&piece, share);
    for a in 0..9 {
        let difference = (at(0.3 + step).values[a] - at(0.3 - step).values[a]) / (2.0 * step);
        assert!((difference - at(0.3).slopes[a]).abs() < 1e-9);
    }
}
