//! Tiles in rows and columns, with text: one picture of many.

use merlkit::Error;
use merlkit::color::Rgb;
use merlkit::image::{Image, MAX_PIXELS};

use crate::labels::Label;

/// Rows and columns of tiles of one size.
pub struct Grid {
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// Width and height of a tile.
    pub tile: [usize; 2],
    /// Pixels around tiles.
    pub gap: usize,
    /// Height of the line over the columns; 0 for none.
    pub heading: usize,
    /// Height of the line under each tile; 0 for none.
    pub label: usize,
    /// Radiance of the letters.
    pub ink: Rgb,
}

/// What is in a place of a grid.
#[derive(Default)]
pub struct Cell {
    /// The picture; `None` leaves the place empty.
    pub image: Option<Image>,
    /// What is written under it.
    pub label: String,
}

impl From<Image> for Cell {
    fn from(image: Image) -> Self {
        Self {
            image: Some(image),
            label: String::new(),
        }
    }
}

/// Height of a line of text under tiles of some width.
pub fn line_height(width: usize) -> usize {
    (width / 12).clamp(12, 22)
}
impl Grid {
    /// A grid for `count` tiles in so many columns, or as near to a square as may be.
    pub fn for_tiles(count: usize, columns: Option<usize>, tile: [usize; 2]) -> Self {
        let square = (count as f64).sqrt().ceil() as usize;
        let columns = columns.unwrap_or(square).min(count).max(1);
        Self {
            columns,
            rows: count.div_ceil(columns),
            tile,
            gap: 0,
            heading: 0,
            label: 0,
            ink: Rgb::ONE,
        }
    }

    /// Width and height of the picture.
    pub fn size(&self) -> [usize; 2] {
        let [width, height] = self.tile;
        [
            self.columns * (width + self.gap) + self.gap,
            self.rows * (height + self.label + self.gap) + self.gap + self.heading,
        ]
    }

    /// Refuses a picture that is too large, before the work.
    ///
    /// # Errors
    /// [`Error::Argument`] for more than [`MAX_PIXELS`] pixels.
    pub fn check(&self) -> Result<(), Error> {
        let [width, height] = self.size();
        if width.saturating_mul(height) <= MAX_PIXELS {
            return Ok(());
        }
        Err(Error::argument(
            format!("a picture of {width} × {height} pixels"),
            format!("choose a smaller --size; a picture has at most {MAX_PIXELS} pixels"),
        ))
    }

    /// Upper left corner of the tile of that number, row after row.
    fn corner(&self, number: usize) -> (usize, usize) {
        let (column, row) = (number % self.columns, number / self.columns);
        let [width, height] = self.tile;
        (
            self.gap + column * (width + self.gap),
            self.gap + self.heading + row * (height + self.label + self.gap),
        )
    }

    /// All tiles, each with its label below, and the headings over the columns. What is around them is black, or transparent if a
    /// tile has a transparent background.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn compose(&self, headings: &[String], cells: &[Cell]) -> Result<Image, Error> {
        let [width, height] = self.size();
        let mut canvas = Canvas {
            width,
            ink: self.ink,
            pixels: vec![Rgb::ZERO; width * height],
            alpha: vec![0.0; width * height],
        };
        for (column, heading) in headings.iter().enumerate() {
            let (left, _) = self.corner(column);
            canvas.write(heading, [left, self.gap], [self.tile[0], self.heading]);
        }
        for (number, cell) in cells.iter().enumerate() {
            let (left, top) = self.corner(number);
            if let Some(image) = &cell.image {
                canvas.paste(image, [left, top]);
            }
            let below = [left, top + self.tile[1]];
            canvas.write(&cell.label, below, [self.tile[0], self.label]);
        }
        let image = Image::new(width, height, canvas.pixels)?;
        let images = cells.iter().filter_map(|cell| cell.image.as_ref());
        match images.filter_map(Image::alpha).next() {
            Some(_) => image.with_alpha(canvas.alpha),
            None => Ok(image),
        }
    }
}

/// A picture that tiles and text are put on.
struct Canvas {
    width: usize,
    ink: Rgb,
    pixels: Vec<Rgb>,
    alpha: Vec<f32>,
}

impl Canvas {
    fn paste(&mut self, image: &Image, [left, top]: [usize; 2]) {
        for y in 0..image.height() {
            for x in 0..image.width() {
                let i = (top + y) * self.width + left + x;
                self.pixels[i] = image.pixel(x, y);
                let alpha = image.alpha();
                self.alpha[i] = alpha.map_or(1.0, |alpha| alpha[y * image.width() + x]);
            }
        }
    }

    fn write(&mut self, text: &str, [left, top]: [usize; 2], [width, height]: [usize; 2]) {
        let label = Label::new(text, width, height);
        for y in 0..height {
            for x in 0..width {
                if label.is_inked(x, y) {
                    let i = (top + y) * self.width + left + x;
                    self.pixels[i] = self.ink;
                    self.alpha[i] = 1.0;
                }
            }
        }
    }
}
/// Most spheres in a row, where nothing is said.
const COLUMNS: usize = 5;

/// Pixels of a tile's sides, at least: with fewer, nothing can be seen.
const LEAST_SIDE: usize = 8;

/// Where so many spheres are in a picture, each in a tile of its own: in so many columns, and in a picture of so many pixels, if any
/// are asked for.
///
/// # Errors
/// [`Error::Argument`] for a size that is no number of equal tiles, and for tiles in which nothing can be seen.
pub fn lay_out_spheres(
    spheres: usize,
    columns: Option<u32>,
    size: Option<(usize, usize)>,
) -> Result<Grid, Error> {
    let columns = columns.map_or(COLUMNS, |n| n as usize);
    let grid = Grid::for_tiles(spheres, Some(columns), [320, 360]);
    let Some((width, height)) = size else {
        grid.check()?;
        return Ok(grid);
    };
    let (columns, rows) = (grid.columns, grid.rows);
    if width % columns == 0 && height % rows == 0 {
        let tile = [width / columns, height / rows];
        if tile[0].min(tile[1]) < LEAST_SIDE {
            let [w, h] = tile;
            return Err(Error::argument(
                format!("a picture with {w} × {h} pixels for each sphere"),
                "give a larger --size, or another number of --columns",
            ));
        }
        return Ok(Grid { tile, ..grid });
    }
    let wide = width.div_ceil(columns) * columns;
    let high = height.div_ceil(rows) * rows;
    Err(Error::argument(
        format!(
            "{width} × {height} pixels are no {columns} × {rows} equal tiles, one for each sphere"
        ),
        format!("give --size {wide}x{high}, or another number of --columns"),
    ))
}
