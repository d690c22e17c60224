//! A part of the work.

use std::fmt;
use std::str::FromStr;

/// Every `count`-th tile of a file, in the order of [`Plan::tiles`](crate::Plan::tiles), beginning with the `number`-th: 1 ≤ number ≤
/// count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: u32,
    count: u32,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// `None` unless 1 ≤ number ≤ count.
    #[must_use]
    pub fn new(number: u32, count: u32) -> Option<Self> {
        (1..=count).contains(&number).then_some(Self { number, count })
    }

    /// Which part, from 1 on.
    #[must_use]
    pub fn number(&self) -> u32 {
        self.number
    }

    /// How many parts there are.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Whether the tile at a position of that order belongs to it.
    #[must_use]
    pub fn holds(&self, position: usize) -> bool {
        position % self.count as usize == self.number as usize - 1
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        parts
            .and_then(|(number, count)| Self::new(number, count))
            .ok_or_else(|| "expected K/N with K from 1 to N, such as 2/8".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_tiles_out() {
        for position in 0..20 {
            let holders = (1..=3).filter(|&number| Shard::new(number, 3).unwrap().holds(position));
            assert_eq!(holders.count(), 1);
        }
        assert!((0..20).all(|position| Shard::WHOLE.holds(position)));
    }

    #[test]
    fn shards_are_parsed() {
        assert_eq!("2/8".parse(), Ok(Shard { number: 2, count: 8 }));
        assert_eq!("2/8".parse::<Shard>().unwrap().to_string(), "2/8");
        for bad in ["", "0/3", "4/3", "1/0", "1", "1/2/3", "-1/2", "a/b"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
