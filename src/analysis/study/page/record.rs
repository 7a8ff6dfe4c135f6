//! What of a study is kept in a repository: its table as text, its curves and its images as SVG, of the parts of the page.

use super::view::Page;
use crate::{
    analysis::study::{outcome::Outcome, table},
    error::{Error, Result},
};
use askama::Template;

/// Curves, a panel for each scene.
#[derive(Template)]
#[template(path = "curves.svg", config = "src/analysis/study/page/askama.toml")]
struct Curves<'a> {
    page: &'a Page<'a>,
}

/// Images after about the same time, a row for each scene.
#[derive(Template)]
#[template(path = "strips.svg", config = "src/analysis/study/page/askama.toml")]
struct Strips<'a> {
    page: &'a Page<'a>,
}

/// Panels side by side.
const COLUMNS: usize = 2;
/// Size of a panel without its legend (pixels).
const PANEL: [usize; 2] = [480, 330];
/// Contenders side by side in a legend.
const LEGEND_COLUMNS: usize = 2;
/// Height of a line of text (pixels).
const LINE: usize = 16;
/// Width of an image (pixels).
const IMAGE: usize = 160;
/// Room between images (pixels).
const GAP: usize = 8;

impl Curves<'_> {
    fn row_height(&self) -> usize {
        let most = self.page.scenes.iter().map(|view| view.rows.len()).max().unwrap_or(0);
        PANEL[1] + LINE * (most.div_ceil(LEGEND_COLUMNS) + 1)
    }

    fn size(&self) -> [usize; 2] {
        let count = self.page.scenes.len();
        [PANEL[0] * count.min(COLUMNS), self.row_height() * count.div_ceil(COLUMNS)]
    }

    fn place(&self, index: &usize) -> [usize; 2] {
        [PANEL[0] * (index % COLUMNS), self.row_height() * (index / COLUMNS)]
    }

    fn place_in_legend(&self, index: &usize) -> [usize; 2] {
        let width = (PANEL[0] - 40) / LEGEND_COLUMNS;
        [40 + width * (index % LEGEND_COLUMNS), PANEL[1] + LINE * (index / LEGEND_COLUMNS)]
    }

    fn style(&self) -> &'static str {
        include_str!("curves.css")
    }
}

impl Strips<'_> {
    /// Height of a scene's images, of the first scenes' rows together where `index` is their number.
    fn top(&self, index: &usize) -> usize {
        self.page.scenes[..*index].iter().map(|view| 4 * LINE + self.height(&view.strips) + GAP).sum()
    }

    fn height(&self, strips: &super::strips::Strips) -> usize {
        IMAGE * strips.height / strips.width.max(1)
    }

    fn size(&self) -> [usize; 2] {
        let most = self.page.scenes.iter().map(|view| view.strips.count()).max().unwrap_or(0);
        [most * (IMAGE + GAP) + GAP, self.top(&self.page.scenes.len())]
    }

    fn left(&self, index: &usize) -> usize {
        GAP + index * (IMAGE + GAP)
    }

    fn style(&self) -> &'static str {
        include_str!("curves.css")
    }
}

/// Names and contents of all files.
pub(super) fn files(outcome: &Outcome, page: &Page<'_>) -> Result<[(&'static str, String); 3]> {
    let drawn = |drawing: std::result::Result<String, askama::Error>| {
        drawing.map_err(|error| {
            Error::new(
                "the record of a study",
                "a study that can be drawn",
                error.to_string(),
                "report this study.json",
            )
        })
    };
    Ok([
        ("convergence.md", markdown(outcome)),
        ("convergence.svg", drawn(Curves { page }.render())?),
        ("convergence_strips.svg", drawn(Strips { page }.render())?),
    ])
}

fn markdown(outcome: &Outcome) -> String {
    let Outcome { made_by, command, machine, conditions, .. } = outcome;
    let conditions =
        conditions.as_ref().map_or(String::new(), |known| format!(" Measured {}", known.sentence()));
    format!(
        "# Error against run time\n\n\
         ![relMSE against seconds, both axes logarithmic, a panel for each scene](convergence.svg)\n\n\
         Means over seeds with their intervals; the dashed line is the reference's own error. Below, after about the same \
         time:\n\n![each scene's reference, and its image by each contender](convergence_strips.svg)\n\n\
         {made_by}; {machine}.{conditions}\n\n```\n{command}\n```\n\n```\n{}\n```\n",
        table::text(outcome).trim_end()
    )
}
