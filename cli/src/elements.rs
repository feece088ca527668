use std::str::FromStr;

/// Elements of a solid through the wall, around and along, written as three numbers with commas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elements(pub [u32; 3]);

impl FromStr for Elements {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[radial @ 1..=100, around @ 1..=10_000, along @ 1..=100_000]) => {
                Ok(Elements([radial, around, along]))
            }
            _ => {
                Err("write three whole numbers, through the wall (1 to 100), around and along, as in 1,12,90"
                    .into())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_three_whole_numbers() {
        assert_eq!("1,12,90".parse(), Ok(Elements([1, 12, 90])));
        for wrong in ["1,12", "0,12,90", "1,12,90,4", "a", "1,-2,90", "1,12,1e9", ""] {
            let error = wrong.parse::<Elements>().unwrap_err();
            assert!(error.contains("as in 1,12,90"), "{wrong}");
        }
    }
}
