//! The conversion of an SVG with the fonts of the system, by resvg and svg2pdf.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Family, Query};
use resvg::usvg::{Options, Tree};
use std::io;
use std::sync::{Arc, OnceLock};
use svg2pdf::{ConversionOptions, PageOptions};

/// Pixels of the file per px of the picture: 640 px become 300 dots per inch at a width of 16 cm.
const DENSITY: f32 = 3.0;
/// Fonts for "sans-serif": the first that exists is taken; the pictures' texts were measured with fonts of this width.
const SANS_SERIF: [&str; 5] = ["DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica"];

/// px per inch, as browsers have it.
const PX_PER_INCH: f32 = 96.0;

/// Returns a picture as PNG.
///
/// # Errors
/// No valid SVG, or no font.
pub fn png(svg: &str) -> io::Result<Vec<u8>> {
    let tree = tree(svg)?;
    let of_no_size = || io::Error::other("the picture has no size");
    let size = tree.size().to_int_size().scale_by(DENSITY).ok_or_else(of_no_size)?;
    let too_large = || io::Error::other("the picture is too large");
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or_else(too_large)?;
    resvg::render(&tree, Transform::from_scale(DENSITY, DENSITY), &mut pixels.as_mut());
    pixels.encode_png().map_err(io::Error::other)
}

/// Draws a picture upon pixels, one to a px.
///
/// # Errors
/// No valid SVG, or no font.
pub fn draw_upon(pixels: &mut Pixmap, svg: &str) -> io::Result<()> {
    resvg::render(&tree(svg)?, Transform::identity(), &mut pixels.as_mut());
    Ok(())
}

/// Returns a picture as PDF: one page of its size, lines and text as such.
///
/// # Errors
/// No valid SVG, or no font.
pub fn pdf(svg: &str) -> io::Result<Vec<u8>> {
    let page = PageOptions { dpi: PX_PER_INCH };
    svg2pdf::to_pdf(&tree(svg)?, ConversionOptions::default(), page)
        .map_err(|error| io::Error::other(error.to_string()))
}

fn tree(svg: &str) -> io::Result<Tree> {
    let fonts = fonts();
    if fonts.is_empty() {
        return Err(io::Error::other("no font is installed: a picture would have no text"));
    }
    let options = Options { fontdb: fonts, ..Options::default() };
    Tree::from_str(svg, &options).map_err(io::Error::other)
}

/// The fonts of the system, found once.
fn fonts() -> Arc<Database> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let load = || {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        let is_there =
            |name: &&str| fonts.query(&Query { families: &[Family::Name(name)], ..Query::default() }).is_some();
        let first = || fonts.faces().find_map(|face| Some(face.families.first()?.0.clone()));
        let family = SANS_SERIF.iter().find(|name| is_there(name)).map(|name| (*name).to_owned()).or_else(first);
        family.into_iter().for_each(|family| fonts.set_sans_serif_family(family));
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}

#[cfg(test)]
mod test;
