//! PNG from SVG, in builds with the feature `png-plots`.

use merlkit::Error;

/// Pixels for each of the SVG's.
#[cfg(feature = "png-plots")]
const SCALE: f32 = 2.0;

/// Whether PNG can be made at all.
///
/// # Errors
/// [`Error::Argument`] in a build that can't.
pub fn check() -> Result<(), Error> {
    if cfg!(feature = "png-plots") {
        return Ok(());
    }
    Err(Error::argument(
        "this build draws SVG only",
        "name a file that ends in .svg, or build with --features png-plots",
    ))
}

/// The picture at twice its size on white, its text in the system's sans-serif.
///
/// # Errors
/// [`Error::Argument`] where the system has no font.
#[cfg(feature = "png-plots")]
pub fn png(svg: &str) -> Result<Vec<u8>, Error> {
    use resvg::{tiny_skia, usvg};
    let broken = |e: String| Error::argument(format!("the picture can't be drawn: {e}"), "report this");
    let mut options = usvg::Options::default();
    options.fontdb_mut().load_system_fonts();
    if options.fontdb.is_empty() {
        let fix = "install one, as the package fonts-dejavu, or name a file that ends in .svg";
        return Err(Error::argument("there is no font for the picture's text", fix));
    }
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| broken(e.to_string()))?;
    let side = |length: f32| (length * SCALE).ceil() as u32;
    let mut pixels = tiny_skia::Pixmap::new(side(tree.size().width()), side(tree.size().height()))
        .ok_or_else(|| broken("it has no size".into()))?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| broken(e.to_string()))
}

/// As [`check`].
///
/// # Errors
/// Always.
#[cfg(not(feature = "png-plots"))]
pub fn png(_: &str) -> Result<Vec<u8>, Error> {
    check().map(|()| Vec::new())
}
