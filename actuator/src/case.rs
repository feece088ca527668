use crate::Module;

/// Case number 1 to 5, and which of the FREEs, in their order around the axis.
const PATTERNS: [(&str, [bool; 4]); 5] = [
    ("case 1: all", [true; 4]),
    ("case 2: diagonal pair", [true, false, true, false]),
    ("case 3: one", [true, false, false, false]),
    ("case 4: adjacent pair", [true, true, false, false]),
    ("case 5: three", [true, true, true, false]),
];

/// FREEs that are inflated together while the others are idle, as in the cases of Buffinton et al. 2020.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Case {
    /// In words.
    pub name: &'static str,
    /// Of each FREE of the module.
    pub inflated: Vec<bool>,
}

impl Case {
    /// Pressures of the FREEs between an idle and a full one each, at a part of the way.
    pub fn pressures(&self, idle: &[f64], full: &[f64], part: f64) -> Vec<f64> {
        let each = self.inflated.iter().zip(idle.iter().zip(full));
        // At the end the full pressure itself: a rounding above it would be outside a model.
        let between = |idle: f64, full: f64| if part < 1.0 { idle + part * (full - idle) } else { full };
        each.map(|(inflated, (idle, full))| if *inflated { between(*idle, *full) } else { *idle }).collect()
    }

    /// The five cases of a module of four FREEs; of others all together and each first one.
    pub fn all(module: &Module) -> Vec<Self> {
        let count = module.frees.len();
        if count != 4 {
            let one = |free: usize| (0..count).map(|other| other == free).collect();
            let cases = [("all", vec![true; count]), ("one", one(0))];
            return cases.into_iter().map(|(name, inflated)| Case { name, inflated }).collect();
        }
        let middle = [0, 1]
            .map(|axis| module.frees.iter().map(|placed| placed.position[axis]).sum::<f64>() / count as f64);
        let around = |free: &usize| {
            let [x, y] = module.frees[*free].position;
            (y - middle[1]).atan2(x - middle[0]).rem_euclid(std::f64::consts::TAU)
        };
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| around(a).total_cmp(&around(b)));
        let placed = |pattern: [bool; 4]| {
            let mut inflated = vec![false; count];
            order.iter().zip(pattern).for_each(|(free, on)| inflated[*free] = on);
            inflated
        };
        PATTERNS.into_iter().map(|(name, pattern)| Case { name, inflated: placed(pattern) }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Description, Rig};

    #[test]
    fn neighbours_are_neighbours_in_whatever_order_they_stand() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/modules");
        let rig = Rig::read(&folder.join("buffinton-2020-60lr.toml")).unwrap();
        let Description::Module(mut module) = rig.description else { panic!("a module") };
        module.frees.swap(1, 2);
        let cases = Case::all(&module);
        assert_eq!(cases.len(), 5);
        let corner = |free: usize| module.frees[free].position;
        let of = |case: &Case| (0..4).filter(|free| case.inflated[*free]).map(corner).collect::<Vec<_>>();
        let [a, b] = of(&cases[3])[..] else { panic!("two") };
        assert!((a[0] == b[0]) != (a[1] == b[1]), "{a:?} {b:?} are not side by side");
        let [a, b] = of(&cases[1])[..] else { panic!("two") };
        assert_eq!(a, b.map(|x| -x));
        assert_eq!(cases[4].pressures(&[1.0; 4], &[5.0; 4], 0.5).iter().sum::<f64>(), 10.0);
        module.frees.pop();
        assert_eq!(Case::all(&module).len(), 2);
    }
}
