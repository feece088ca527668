//! `freeact reproduce` of the paper's modules, coarse: cases, reachable set, loads, families of fibres.

use freeact_tests::{Table, freeact};
use std::{fs, path::Path};

fn run(names: &[&str], out: &Path) -> serde_json::Value {
    let out = out.display().to_string();
    let arguments = ["reproduce"].into_iter().chain(names.iter().copied());
    freeact(arguments.chain(["--out", &out, "--coarse", "--json"])).succeeded().json()
}

#[test]
fn modules_move_as_their_hands_say_and_their_claims_are_judged() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let out = folder.path();
    let value = run(&["fig8", "p11", "fig13", "p13"], out);
    let claims: Vec<_> = value["studies"]
        .as_array()
        .expect("studies")
        .iter()
        .flat_map(|study| study["claims"].as_array().expect("claims"))
        .collect();
    let verdict = |words: &str| {
        let claim =
            claims.iter().find(|claim| claim["claim"].as_str().is_some_and(|claim| claim.contains(words)));
        claim.unwrap_or_else(|| panic!("no claim says {words}"))["verdict"].as_str().expect("a verdict")
    };
    for case in ["case 1: pure elongation", "case 2: rotation without bending", "case 4: pure bending"] {
        assert_eq!(verdict(&format!("30 LR, {case}")), "holds");
    }
    // Wound at 60 degrees from the hoop a FREE contracts, and its bending goes far beyond what the paper reports.
    assert_eq!(verdict("60 LR, case 1"), "does not hold");
    assert_eq!(verdict("60 LR, angle from the hoop"), "does not hold");
    assert_eq!(verdict("concave"), "holds");
    assert_eq!(verdict("dynamics"), "cannot be judged");

    let cases = Table::read(&out.join("fig8-cases.csv"));
    let rows = |module: &str, spacers: &str, case: &str| {
        let wanted = |row: &&Vec<String>| row[0] == module && row[1] == spacers && row[2] == case;
        cases.rows.iter().filter(wanted).collect::<Vec<_>>()
    };
    let number = |row: &[String], column: &str| cases.number(row, column);
    for module in ["30 LR", "60 LR"] {
        for (case, spacers) in
            ["1", "2", "3", "4", "5"].into_iter().flat_map(|case| [(case, "9"), (case, "0")])
        {
            let rows = rows(module, spacers, case);
            assert!(rows.len() > 3 && number(rows[0], "pressure_kpa") == 0.0, "{module} {spacers} {case}");
        }
        // Tied: opposite hands cancel; one hand turns alone, about the axis.
        for row in rows(module, "9", "1").iter().chain(&rows(module, "9", "4")) {
            assert!(number(row, "twist_deg").abs() < 0.01, "{row:?}");
        }
        for row in rows(module, "9", "2") {
            assert!(number(row, "x_mm").hypot(number(row, "y_mm")) < 0.01, "{row:?}");
        }
        let last = rows(module, "9", "2").last().map_or(0.0, |row| number(row, "twist_deg"));
        assert!(last < -100.0, "{module}: a right-handed pair turns by {last} degrees");
    }

    let spacing = Table::read(&out.join("fig11-spacing.csv"));
    assert!(spacing.rows.len() > 12 * 4 * 3);
    for stem in ["fig8-30lr-twist", "fig9-60lr-sideways", "fig11-hoop-xy", "fig12-hoop-xz", "p13-stiffness"] {
        let svg = fs::read_to_string(out.join(format!("{stem}.svg"))).expect(stem);
        assert!(svg.contains("simulated") && !svg.contains("NaN"), "{stem}");
        assert_eq!(&fs::read(out.join(format!("{stem}.png"))).expect(stem)[1..4], b"PNG");
    }
    let summary = fs::read_to_string(out.join("summary.md")).expect("the summary");
    for words in [
        "Spacing, ties and what the angle is measured from",
        "Families of fibres",
        "Arruda-Boyce, locks at 5",
    ] {
        assert!(summary.contains(words), "{words}");
    }
    // The turning plate takes the ends of idle FREEs along and bends them, the more the farther it turns.
    let idle = Table::read(&out.join("fig13-idle.csv"));
    for angle in ["60", "30"] {
        let bare = idle.rows.iter().filter(|row| row[0] == angle && idle.number(row, "idle_kpa") == 0.0);
        let bows: Vec<f64> = bare.map(|row| idle.number(row, "bow_mm")).collect();
        assert_eq!(bows.len(), 4);
        assert!(bows[0] > 0.0 && bows.windows(2).all(|pair| pair[1] > pair[0]), "{angle}: {bows:?}");
    }
    let stiffness = Table::read(&out.join("p13-stiffness.csv"));
    assert_eq!(stiffness.rows.len(), 9);
    for row in &stiffness.rows {
        for column in ["sideways_mm_per_n", "along_mm_per_n", "twist_deg_per_nmm"] {
            assert!(stiffness.number(row, column) > 0.0, "{column} of a stable state: {row:?}");
        }
    }
}
