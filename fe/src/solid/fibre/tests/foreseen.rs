use super::{truss::*, *};

/// Greatest change of the tangent of one element at positions when its tensions are those foreseen from `step` times `direction` before,
/// over `part` of that way.
fn change(
    element: &FibreElement,
    positions: &[[f64; 3]],
    direction: &[[f64; 3]],
    [step, part]: [f64; 2],
) -> f64 {
    let before: Vec<[f64; 3]> =
        positions.iter().zip(direction).map(|(x, d)| std::array::from_fn(|i| x[i] - step * d[i])).collect();
    let way: Vec<[f64; 3]> = direction.iter().map(|d| d.map(|d| step * d)).collect();
    let foreseen = ForeseenTensions::new(std::slice::from_ref(element), &before, &way, part);
    let own = evaluated(element, positions).2;
    let mut other = own.clone();
    foreseen.put_into(0, element, positions, &mut other).unwrap();
    own.iter().zip(&other).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Fibres along lines of the mesh and across them: what is foreseen differs from what comes by the square of the step.
#[test]
fn tensions_are_foreseen_to_first_order() {
    let families = [winding(40.0, Handedness::Right, 6, 0.3e-3), winding(55.0, Handedness::Left, 4, 0.0)];
    let (grid, fibres) = trusses(&specimen(&families), mesh(12, 6, true));
    let positions = shaken(&moved(&grid, 1.1, 10.0, 1.1), 2e-4);
    let direction = shaken(&vec![[0.0; 3]; positions.len()], 1.0);
    let mut kinds = [0, 0];
    for element in fibres.elements.iter().step_by(5) {
        kinds[usize::from(matches!(element, FibreElement::Truss(_)))] += 1;
        let at = |step: f64, part: f64| change(element, &positions, &direction, [step, part]);
        let order = |part: f64| (at(2e-6, part) / at(1e-6, part)).log2();
        assert!((order(1.0) - 2.0).abs() < 0.1, "{}", order(1.0));
        // None of the way: the tension there was before, off by the step itself.
        assert!((order(0.0) - 1.0).abs() < 0.1, "{}", order(0.0));
        assert_eq!(at(0.0, 1.0), 0.0);
    }
    assert!(kinds.iter().all(|count| *count > 3), "{kinds:?}");
}
