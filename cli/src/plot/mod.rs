//! Charts: lines and points over two axes, as SVG (reports, papers) and PNG (everything else).

mod chart;
mod curves;
mod drawing;
mod field;
mod font;
mod mark;
mod picture;
mod scale;
mod thin;

pub use chart::Chart;
pub use field::{Field, Patch};
pub use mark::{Mark, Series};
pub use picture::Picture;
pub use thin::thin;
