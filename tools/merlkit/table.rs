//! Sheets and sentences as text that fits a terminal.

use comfy_table::{ColumnConstraint, Table, Width, presets};
use merlkit_evaluate::report::Sheet;

/// Columns of characters that a line takes at most, on a terminal or not, so that output is the same everywhere.
pub const COLUMNS: usize = 100;
/// Characters between two cells, and at the ends of a line.
const BORDER: usize = 3;
const ENDS: usize = 4;
/// A column with a longer cell than this, which has a space, holds words and may be broken into lines.
const WORDS_FROM: usize = 20;

/// The sheet as a Markdown table, which reads well in a terminal and survives copying; ends in a line feed.
///
/// A sheet that is too wide is broken: columns of words into several lines, and then the sheet into blocks under one another,
/// each of which begins with the first column.
pub fn render(sheet: &Sheet) -> String {
    let blocks = split(&measure(sheet));
    let mut texts = Vec::new();
    for columns in &blocks {
        texts.push(render_block(sheet, columns));
    }
    texts.join("\n")
}

/// Text as lines of at most [`COLUMNS`] characters, of which the last ends in a line feed, too. Lines that are short enough stay
/// as they are, and a longer word has a line of its own.
pub fn wrap(text: &str) -> String {
    let mut lines = String::new();
    for paragraph in text.lines() {
        if paragraph.chars().count() <= COLUMNS {
            lines.push_str(paragraph);
            lines.push('\n');
            continue;
        }
        let mut used = 0;
        for word in paragraph.split(' ') {
            let length = word.chars().count();
            if used > 0 && used + 1 + length > COLUMNS {
                lines.push('\n');
                used = 0;
            }
            if used > 0 {
                lines.push(' ');
                used += 1;
            }
            lines.push_str(word);
            used += length;
        }
        lines.push('\n');
    }
    lines
}

/// A column of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Column {
    index: usize,
    /// Characters of its longest cell.
    width: usize,
    /// The fewest characters to which it may be broken.
    least: usize,
}

fn measure(sheet: &Sheet) -> Vec<Column> {
    let mut columns = Vec::new();
    for (index, heading) in sheet.heading.iter().enumerate() {
        let mut width = heading.chars().count();
        let mut longest_word = longest_word(heading);
        let mut is_broken = heading.contains(' ');
        for cell in sheet.rows.iter().filter_map(|row| row.get(index)) {
            width = width.max(cell.chars().count());
            longest_word = longest_word.max(self::longest_word(cell));
            is_broken |= cell.contains(' ');
        }
        let least = if is_broken && width > WORDS_FROM {
            longest_word.max(WORDS_FROM)
        } else {
            width
        };
        columns.push(Column {
            index,
            width,
            least,
        });
    }
    columns
}

fn longest_word(text: &str) -> usize {
    let lengths = text.split(' ').map(|word| word.chars().count());
    lengths.max().unwrap_or(0)
}

/// Columns of each block, as few blocks as possible and these about as wide as each other. Each block repeats the first column.
fn split(columns: &[Column]) -> Vec<Vec<Column>> {
    let fewest = fill_blocks(columns, COLUMNS).len();
    for limit in 0..COLUMNS {
        let blocks = fill_blocks(columns, limit);
        if blocks.len() == fewest && blocks.iter().all(|block| least_width(block) <= limit) {
            return blocks;
        }
    }
    fill_blocks(columns, COLUMNS)
}

/// Blocks of as many columns as fit into `limit` characters when words are broken.
fn fill_blocks(columns: &[Column], limit: usize) -> Vec<Vec<Column>> {
    let Some((&first, rest)) = columns.split_first() else {
        return Vec::new();
    };
    let mut blocks = Vec::new();
    let mut block = vec![first];
    for &column in rest {
        block.push(column);
        if block.len() > 2 && least_width(&block) > limit {
            block.pop();
            blocks.push(block);
            block = vec![first, column];
        }
    }
    blocks.push(block);
    blocks
}

/// Characters of a line of these columns when words are broken.
fn least_width(columns: &[Column]) -> usize {
    let cells: usize = columns.iter().map(|c| c.least).sum();
    cells + ENDS + BORDER * columns.len().saturating_sub(1)
}

fn render_block(sheet: &Sheet, columns: &[Column]) -> String {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(columns.iter().map(|c| &sheet.heading[c.index]));
    for row in &sheet.rows {
        table.add_row(columns.iter().filter_map(|c| row.get(c.index)));
    }
    let widths = fit(columns);
    for (place, (column, width)) in columns.iter().zip(widths).enumerate() {
        if width < column.width
            && let Some(shown) = table.column_mut(place)
        {
            // The constraint counts a space on either side.
            shown.set_constraint(ColumnConstraint::Absolute(Width::Fixed(width as u16 + 2)));
        }
    }
    format!("{}\n", table.trim_fmt())
}

/// Widths at which the columns fit: the widest of those that may be broken gives way first.
fn fit(columns: &[Column]) -> Vec<usize> {
    let mut widths: Vec<usize> = columns.iter().map(|c| c.width).collect();
    let borders = ENDS + BORDER * columns.len().saturating_sub(1);
    while widths.iter().sum::<usize>() + borders > COLUMNS {
        let breakable = (0..columns.len()).filter(|&i| widths[i] > columns[i].least);
        let Some(widest) = breakable.max_by_key(|&i| widths[i]) else {
            break;
        };
        widths[widest] -= 1;
    }
    widths
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widest_line(text: &str) -> usize {
        let lengths = text.lines().map(|line| line.chars().count());
        lengths.max().unwrap_or(0)
    }

    /// A sheet of numbers, each as wide as its heading.
    fn numbers(columns: usize) -> Sheet {
        let names: Vec<String> = (0..columns).map(|i| format!("figure {i:03}")).collect();
        let mut heading = vec!["sampler"];
        heading.extend(names.iter().map(String::as_str));
        let mut sheet = Sheet::new(&heading);
        let mut row = vec!["half-vector:64KB".to_owned()];
        row.extend((0..columns).map(|i| i.to_string()));
        sheet.push(row);
        sheet
    }

    #[test]
    fn what_fits_is_one_table() {
        let text = render(&numbers(3));
        assert_eq!(text.lines().count(), 3);
        assert_eq!(text.matches("half-vector:64KB").count(), 1);
    }

    #[test]
    fn a_wide_sheet_becomes_blocks_that_name_their_rows_and_lose_nothing() {
        let text = render(&numbers(20));
        assert!(widest_line(&text) <= COLUMNS, "{text}");
        for i in 0..20 {
            assert_eq!(text.matches(&format!("figure {i:03}")).count(), 1, "{text}");
        }
        assert_eq!(
            text.matches("half-vector:64KB").count(),
            text.matches("| sampler").count()
        );
        // No block has a single column left over.
        let headings: Vec<&str> = text.lines().filter(|l| l.contains("| sampler")).collect();
        let columns = headings.iter().map(|h| h.matches("figure").count());
        assert!(columns.min() >= Some(5), "{headings:#?}");
    }

    #[test]
    fn words_are_broken_before_columns_are_moved() {
        let mut sheet = Sheet::new(&["setting", "meaning", "default"]);
        let meaning = "one word after another ".repeat(12);
        sheet.push(vec!["depth".into(), meaning.clone(), "14".into()]);
        let text = render(&sheet);
        assert!(widest_line(&text) <= COLUMNS, "{text}");
        assert_eq!(text.matches("setting").count(), 1, "{text}");
        assert_eq!(text.matches("another").count(), 12, "{text}");
    }

    #[test]
    fn paragraphs_are_wrapped_between_words() {
        let text = wrap(&"four words of text ".repeat(20));
        assert!(widest_line(&text) <= COLUMNS && text.lines().count() == 4);
        assert_eq!(text.split_whitespace().count(), 80);
        assert_eq!(wrap("a\n\n  b"), "a\n\n  b\n");
    }
}
