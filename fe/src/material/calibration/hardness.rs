/// Young's modulus (Pa) of a rubber of Shore A hardness S, by Gent's relation (1958, "On the relation between indentation hardness
/// and Young's modulus", Rubber Chem. Technol. 31, eq. 4 with the spring of ASTM D 676):
///
/// E = 0.0981 (56 + 7.62336 S)/(0.137505 (254 - 2.54 S)) MPa.
///
/// `None` outside 0 <= S < 100. Gent compared it with measurements between 20 and 80 or so; a unit of S is 4 to 5 % of E.
pub fn young_modulus_of_shore_a(hardness: f64) -> Option<f64> {
    (0.0..100.0)
        .contains(&hardness)
        .then(|| 1e6 * 0.0981 * (56.0 + 7.62336 * hardness) / (0.137505 * (254.0 - 2.54 * hardness)))
}
