//! Reports: one HTML file that needs nothing else, readable on screen (light and dark) and on paper.

mod page;

pub use page::Page;
#[cfg(test)]
pub use page::check_tags;
