//! A sheet in pixels.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::fmt;
use std::sync::Arc;

/// Pixels of an image per pixel of the sheet: sharp on a fine screen and on paper.
const SCALE: f32 = 2.0;
/// The family that [`dejavu`] has.
const FAMILY: &str = "DejaVu Sans";

/// Why a picture could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PngError {
    /// It is no SVG.
    Svg(String),
    /// It is empty, or larger than an image can be.
    Size,
    /// It could not be encoded.
    Encoding(String),
}

impl fmt::Display for PngError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Svg(why) => write!(f, "the figure is no SVG ({why}); please report it"),
            Self::Size => f.write_str("the figure is too large for a PNG; write it as SVG"),
            Self::Encoding(why) => write!(
                f,
                "the figure cannot be encoded as PNG ({why}); write it as SVG"
            ),
        }
    }
}

impl std::error::Error for PngError {}

/// The bytes of a PNG of an SVG.
///
/// # Errors
/// [`PngError`].
pub fn png(svg: &str) -> Result<Vec<u8>, PngError> {
    let mut options = Options {
        font_family: FAMILY.into(),
        ..Options::default()
    };
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family(FAMILY);
    let tree = Tree::from_str(svg, &options).map_err(|error| PngError::Svg(error.to_string()))?;
    let size = tree
        .size()
        .to_int_size()
        .scale_by(SCALE)
        .ok_or(PngError::Size)?;
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or(PngError::Size)?;
    resvg::render(
        &tree,
        Transform::from_scale(SCALE, SCALE),
        &mut pixels.as_mut(),
    );
    pixels
        .encode_png()
        .map_err(|error| PngError::Encoding(error.to_string()))
}
