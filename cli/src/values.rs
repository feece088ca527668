//! Lists of numbers on the command line: `0.2,0.393,0.6`, the range `10:80:10` (first:last:step), or both: `10:30:5,60`.

use std::str::FromStr;

/// More values than this are a slip of the pen, not a sweep.
const MOST: usize = 100_000;

/// Numbers given as a list, as ranges, or as both; in the order given.
#[derive(Clone, Debug, PartialEq)]
pub struct Values(pub Vec<f64>);

impl FromStr for Values {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut values = Vec::new();
        for piece in text.split(',') {
            let like = "0.2,0.393,0.6 or a range like 10:80:10";
            let numbers = piece.split(':').map(|text| number(text, like)).collect::<Result<Vec<_>, _>>()?;
            match numbers[..] {
                [one] => values.push(one),
                [first, last, step] => values.extend(range(first, last, step)?),
                [_, _] => {
                    return Err(format!(
                        "the range `{piece}` has no step; write first:last:step, as in 10:80:10"
                    ));
                }
                _ => {
                    return Err(format!(
                        "`{piece}` has too many colons; write first:last:step, as in 10:80:10"
                    ));
                }
            }
            if values.len() > MOST {
                return Err(format!("more than {MOST} values; check the step"));
            }
        }
        Ok(Values(values))
    }
}

impl Values {
    /// The values in rising order, or what is wrong with them: `what` names them in the message.
    pub fn rising(&self, what: &str) -> Result<Vec<f64>, String> {
        let mut values = self.0.clone();
        values.sort_by(f64::total_cmp);
        match values.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(format!("{what}: {} is given twice", pair[0])),
            None => Ok(values),
        }
    }
}

/// Exactly `N` numbers between commas.
pub fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let like = "5,-3,178";
    let numbers = text.split(',').map(|text| number(text, like)).collect::<Result<Vec<_>, _>>()?;
    let count = numbers.len();
    numbers
        .try_into()
        .map_err(|_| format!("{count} numbers where {N} are needed, between commas and without spaces"))
}

fn number(text: &str, like: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{}` is not a number; write numbers like {like}", text.trim())),
    }
}

fn range(first: f64, last: f64, step: f64) -> Result<Vec<f64>, String> {
    let steps = (last - first) / step;
    if steps.is_nan() || steps < 0.0 {
        return Err(format!("{first}:{last}:{step} never arrives; the step must lead from first to last"));
    }
    // A last value that decimal fractions miss by rounding is meant to be there: 0:0.3:0.1 has four values.
    let count = (steps + 1e-9).floor();
    if count > MOST as f64 {
        return Err(format!("{first}:{last}:{step} has more than {MOST} values; check the step"));
    }
    let arrives = (steps - count).abs() < 1e-9;
    let count = count as usize;
    let value = |i: usize| if arrives && i == count { last } else { first + i as f64 * step };
    Ok((0..=count).map(value).collect())
}

/// A positive number.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a positive number".into()),
    }
}

/// A share that a tolerance may be.
pub fn share(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (1e-7..=1.0).contains(number));
    number.ok_or_else(|| "must be a share from 1e-7 to 1".into())
}

/// A multiple of the volume at a limit pressure.
pub fn ratio(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| *number > 1.0 && *number <= 20.0);
    number.ok_or_else(|| "must be a multiple of the volume above 1 and up to 20, as in 1.5".into())
}

/// Positive numbers.
pub fn positive_list(text: &str) -> Result<Values, String> {
    let values: Values = text.parse()?;
    match values.0.iter().find(|value| **value <= 0.0) {
        Some(value) => Err(format!("{value} is not positive")),
        None => Ok(values),
    }
}

/// Winding angles from the hoop, degrees.
pub fn winding_angles(text: &str) -> Result<Values, String> {
    let values: Values = text.parse()?;
    match values.0.iter().find(|value| !(1.0..=89.5).contains(*value)) {
        Some(value) => Err(format!("{value} is not between 1 and 89.5 degrees from the hoop direction")),
        None => Ok(values),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<f64> {
        text.parse::<Values>().unwrap().0
    }

    #[test]
    fn ranges_hold_their_last_value() {
        assert_eq!(values("10:80:10"), [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0]);
        assert_eq!(values("0:0.3:0.1").len(), 4);
        assert_eq!(values("0:0.3:0.1")[3], 0.3);
        assert_eq!(values("0:1:0.4"), [0.0, 0.4, 0.8]);
        assert_eq!(values("3:1:-1"), [3.0, 2.0, 1.0]);
        assert_eq!(values("5:5:1"), [5.0]);
    }

    #[test]
    fn lists_and_ranges_mix() {
        assert_eq!(values("0.2,0.393,0.6"), [0.2, 0.393, 0.6]);
        assert_eq!(values("10:20:5, 40"), [10.0, 15.0, 20.0, 40.0]);
    }

    #[test]
    fn what_is_no_list_says_so() {
        for (text, word) in [
            ("10:80", "no step"),
            ("1:2:3:4", "too many colons"),
            ("10:80:-1", "never arrives"),
            ("10:80:0", "check the step"),
            ("5:5:0", "never arrives"),
            ("0:1:1e-12", "check the step"),
            ("ten", "not a number"),
            ("", "not a number"),
            ("nan", "not a number"),
            ("1,,2", "not a number"),
        ] {
            let message = text.parse::<Values>().unwrap_err();
            assert!(message.contains(word), "{text}: {message}");
        }
    }

    #[test]
    fn a_position_has_three_numbers() {
        assert_eq!(numbers::<3>("5,-3,1.5e2").unwrap(), [5.0, -3.0, 150.0]);
        assert!(numbers::<3>("0,175").unwrap_err().contains("2 numbers where 3"));
        assert!(numbers::<3>("nan,0,175").unwrap_err().contains("not a number"));
        // A position knows no ranges.
        assert!(!numbers::<3>("0:2:1,0,175").unwrap_err().contains("range"));
    }

    #[test]
    fn doubles_are_found() {
        assert_eq!(Values(vec![3.0, 1.0]).rising("angles").unwrap(), [1.0, 3.0]);
        assert!(
            Values(vec![3.0, 1.0, 3.0]).rising("angles").unwrap_err().contains("angles: 3 is given twice")
        );
    }
}
