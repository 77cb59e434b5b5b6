//! Names under pictures, in the fixed-width bitmap fonts of `embedded-graphics`, which are part of the program.

use std::convert::Infallible;

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::iso_8859_1::{
    FONT_4X6, FONT_5X8, FONT_6X10, FONT_8X13, FONT_10X20,
};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Alignment, Baseline, Text};

/// From the largest to the smallest.
const FONTS: [&MonoFont; 5] = [&FONT_10X20, &FONT_8X13, &FONT_6X10, &FONT_5X8, &FONT_4X6];

/// A line of text, black on white or the reverse.
pub struct Label {
    width: usize,
    height: usize,
    inked: Vec<bool>,
}

impl Label {
    /// `text` in the middle of a line of that size, in the largest font in which it fits. What is too long for the smallest
    /// ends in "…", of which nothing is left where not even that fits.
    pub fn new(text: &str, width: usize, height: usize) -> Self {
        let mut label = Self {
            width,
            height,
            inked: vec![false; width * height],
        };
        let length = text.chars().count();
        let fits = |font: &&&MonoFont| {
            let size = font.character_size;
            size.width as usize * length <= width && size.height as usize <= height
        };
        let font = FONTS.iter().find(fits).unwrap_or(&&FONT_4X6);
        let room = width / font.character_size.width as usize;
        let shown = if length <= room {
            text.to_owned()
        } else {
            // The fonts have Latin-1 alone, and no ellipsis.
            let mut cut: String = text.chars().take(room.saturating_sub(2)).collect();
            cut.push_str("..");
            cut
        };
        let style = MonoTextStyle::new(font, BinaryColor::On);
        let middle = Point::new(
            width as i32 / 2,
            (height as i32 - font.character_size.height as i32) / 2,
        );
        let mut line = Text::with_baseline(&shown, middle, style, Baseline::Top);
        line.text_style.alignment = Alignment::Center;
        // Drawing on memory can't fail.
        let _ = line.draw(&mut label);
        label
    }

    /// Whether a pixel belongs to a letter; column and row from the upper left.
    pub fn is_inked(&self, x: usize, y: usize) -> bool {
        self.inked[y * self.width + x]
    }
}

impl OriginDimensions for Label {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Label {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(at, colour) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(at.x), usize::try_from(at.y)) else {
                continue;
            };
            if x < self.width && y < self.height {
                self.inked[y * self.width + x] = colour.is_on();
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inked(label: &Label) -> usize {
        label.inked.iter().filter(|ink| **ink).count()
    }

    #[test]
    fn every_name_fits_or_is_cut() {
        assert!(inked(&Label::new("nickel", 96, 12)) > 20);
        // Longer names take smaller letters.
        let long = Label::new("grease-covered-steel", 96, 12);
        assert!(inked(&long) > 20);
        assert!(inked(&Label::new("ward:sx=0.1,sy=0.4,ks=0.5,kd=0.5", 96, 12)) > 20);
        assert_eq!(inked(&Label::new("", 96, 12)), 0);
        Label::new("nickel", 1, 1);
        Label::new("Lucite-ünïcødé-κόσμε", 40, 12);
    }
}
