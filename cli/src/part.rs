use std::str::FromStr;

/// A part of a sweep, written `i/n` and counted from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part(pub fe::Shard);

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<(usize, usize)> =
            text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, count)) if 1 <= index && index <= count => {
                Ok(Part(fe::Shard { index: index - 1, count }))
            }
            _ => Err("write i/n with i from 1 to n, as in 1/4".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_counted_from_one() {
        assert_eq!("2/4".parse::<Part>().unwrap().0, fe::Shard { index: 1, count: 4 });
        for wrong in ["0/4", "5/4", "1", "a/b", "-1/2", "1/0"] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
    }
}
