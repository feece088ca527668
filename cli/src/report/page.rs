use crate::{failure::Failure, output, plot::Chart};
use std::path::Path;

/// A page in the making: call the parts in their order, then [`Page::save`].
pub struct Page {
    title: String,
    body: String,
}

/// Text made safe to stand in HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

impl Page {
    /// A page with a title and a line under it.
    pub fn new(title: &str, subtitle: &str) -> Self {
        let title = escape(title);
        let body = format!("<h1>{title}</h1>\n<p class=\"faint\">{}</p>\n", escape(subtitle));
        Page { title, body }
    }

    /// The sentence that a hurried reader takes away.
    pub fn lead(&mut self, text: &str) {
        self.body += &format!("<p class=\"lead\">{}</p>\n", escape(text));
    }

    /// A heading.
    pub fn section(&mut self, heading: &str) {
        self.body += &format!("<h2>{}</h2>\n", escape(heading));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.body += &format!("<p>{}</p>\n", escape(text));
    }

    /// A table; a head that begins with `<` is set flush left, the others flush right.
    pub fn table(&mut self, head: &[&str], rows: &[Vec<String>]) {
        let class = |i: usize| match head.get(i) {
            Some(head) if head.starts_with('<') => " class=\"left\"",
            _ => "",
        };
        let cells = |tag: &str, row: &mut dyn Iterator<Item = String>| {
            row.enumerate().map(|(i, cell)| format!("<{tag}{}>{cell}</{tag}>", class(i))).collect::<String>()
        };
        self.body += "<div class=\"scroll\"><table>\n<thead><tr>";
        self.body += &cells("th", &mut head.iter().map(|head| escape(head.trim_start_matches('<'))));
        self.body += "</tr></thead>\n<tbody>\n";
        for row in rows {
            self.body += &format!("<tr>{}</tr>\n", cells("td", &mut row.iter().map(|cell| escape(cell))));
        }
        self.body += "</tbody></table></div>\n";
    }

    /// Charts side by side where the screen is wide enough, each with a sentence under it.
    pub fn figures(&mut self, charts: &[(Chart, String)]) -> Result<(), Failure> {
        let drawn = charts.iter().map(|(chart, caption)| {
            let svg = chart.inline_svg().map_err(Failure::file)?;
            Ok((chart.title.as_str(), svg, caption.as_str()))
        });
        let drawn = drawn.collect::<Result<Vec<_>, Failure>>()?;
        self.drawings(&drawn);
        Ok(())
    }

    /// The same for drawings of any kind: title, SVG element, sentence under it.
    pub fn drawings(&mut self, drawings: &[(&str, String, &str)]) {
        self.body += "<div class=\"figures\">\n";
        for (title, svg, caption) in drawings {
            let (label, caption) = (escape(title), escape(caption));
            let svg = svg.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{label}\" "), 1);
            self.body += &format!("<figure>\n{svg}<figcaption>{caption}</figcaption></figure>\n");
        }
        self.body += "</div>\n";
    }

    /// The whole page.
    pub fn html(&self) -> String {
        let Page { title, body } = self;
        let style = include_str!("style.css");
        let version = env!("CARGO_PKG_VERSION");
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>\n{style}</style>\n</head>\n<body>\n{body}<footer>freeact {version}. Winding angles are measured \
             from the hoop (circumferential) direction; pressures are gauge.</footer>\n</body>\n</html>\n"
        )
    }

    /// Writes the page.
    pub fn save(&self, path: &Path) -> Result<(), Failure> {
        output::save(path, self.html().as_bytes())
    }
}

/// Panics unless every tag is closed in its order, and nothing is fetched from elsewhere.
#[cfg(test)]
pub fn check_tags(html: &str) {
    let mut open: Vec<String> = Vec::new();
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("a tag that does not end");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        let name: String = tag.trim_start_matches('/').chars().take_while(|c| c.is_alphanumeric()).collect();
        if tag.starts_with('/') {
            assert_eq!(open.pop().as_deref(), Some(name.as_str()), "closed in the wrong order");
        } else if !tag.ends_with('/') && !tag.starts_with('!') && name != "meta" {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "never closed: {open:?}");
    for fetched in ["href=", "src=", "url(", "@import"] {
        assert!(!html.contains(fetched), "{fetched} would fetch something");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Mark, Series};

    #[test]
    fn a_page_is_whole_and_alone() {
        let mut page = Page::new("Rig <a> & b", "made from a.csv");
        page.lead("Nothing is missing.");
        page.section("Numbers");
        page.table(&["<name", "value (mm)"], &[vec!["x < y".into(), "1.0".into()]]);
        let line = Series::new("seen", Mark::Line, vec![(0.0, 0.0), (1.0, 2.0)]);
        page.figures(&[(Chart::new("c \"d\"", "x (s)", "y (mm)").with(line), "A line.".into())]).unwrap();
        let html = page.html();
        check_tags(&html);
        assert!(html.contains("Rig &lt;a&gt; &amp; b") && html.contains("<td class=\"left\">x &lt; y</td>"));
        assert!(html.contains("<th>value (mm)</th>") && html.contains("prefers-color-scheme: dark"));
    }
}
