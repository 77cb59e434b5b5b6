//! The tables of the 2008 thesis, each compiled in from `data/thesis` and read here alone.

/// Table 5.9: memory of uniform cascade CDFs.
pub(crate) const TABLE_5_9: &str =
    include_str!("../../../../data/thesis/table_5_9_cascade_uniform_memory.csv");
/// Table 5.10: compressed cascade CDFs.
pub(crate) const TABLE_5_10: &str =
    include_str!("../../../../data/thesis/table_5_10_cascade_compressed_memory.csv");
/// Table 6.14: errors of scene 2, sphere 2.
pub(crate) const TABLE_6_14: &str =
    include_str!("../../../../data/thesis/table_6_14_sphere2_relative_error_percent.csv");
/// Table 6.22: errors of scene 6.
pub(crate) const TABLE_6_22: &str = include_str!(
    "../../../../data/thesis/table_6_22_scene6_environment_relative_error_percent.csv"
);
/// Table 6.23: seconds and KB of three samplers of measured materials.
pub(crate) const TABLE_6_23: &str =
    include_str!("../../../../data/thesis/table_6_23_precompute_and_memory.csv");
/// Table 6.24: seconds of drawing.
pub(crate) const TABLE_6_24: &str =
    include_str!("../../../../data/thesis/table_6_24_sampling_time.csv");

/// One table, as printed: each row begins with its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PublishedTable {
    /// Its number in the thesis; `text` for figures that are not in a table.
    pub number: &'static str,
    csv: &'static str,
}

/// All tables that `data/thesis` has.
pub const PUBLISHED_TABLES: [PublishedTable; 24] = [
    published("5.9", TABLE_5_9),
    published("5.10", TABLE_5_10),
    published(
        "6.4",
        include_str!("../../../../data/thesis/table_6_4_scene2_precomputation_s.csv"),
    ),
    published(
        "6.5",
        include_str!("../../../../data/thesis/table_6_5_quadtree_memory_by_nmax.csv"),
    ),
    published(
        "6.6",
        include_str!("../../../../data/thesis/table_6_6_disc_and_factored_memory.csv"),
    ),
    published(
        "6.7",
        include_str!("../../../../data/thesis/table_6_7_scene1_drawing_s.csv"),
    ),
    published(
        "6.8",
        include_str!("../../../../data/thesis/table_6_8_scene1_relative_error_percent.csv"),
    ),
    published(
        "6.9",
        include_str!("../../../../data/thesis/table_6_9_scene2_disc_drawing_time.csv"),
    ),
    published(
        "6.10",
        include_str!("../../../../data/thesis/table_6_10_scene2_disc_relative_error_percent.csv"),
    ),
    published(
        "6.11",
        include_str!("../../../../data/thesis/table_6_11_sphere1_drawing_time.csv"),
    ),
    published(
        "6.12",
        include_str!("../../../../data/thesis/table_6_12_sphere1_relative_error_percent.csv"),
    ),
    published(
        "6.13",
        include_str!("../../../../data/thesis/table_6_13_sphere2_drawing_time.csv"),
    ),
    published("6.14", TABLE_6_14),
    published(
        "6.15",
        include_str!("../../../../data/thesis/table_6_15_scene4_precomputation_s.csv"),
    ),
    published(
        "6.16",
        include_str!("../../../../data/thesis/table_6_16_scene4_drawing_s.csv"),
    ),
    published(
        "6.17",
        include_str!("../../../../data/thesis/table_6_17_scene4_relative_error_percent.csv"),
    ),
    published(
        "6.19",
        include_str!("../../../../data/thesis/table_6_19_factorisations.csv"),
    ),
    published(
        "6.20",
        include_str!("../../../../data/thesis/table_6_20_scene6_precomputation_s.csv"),
    ),
    published(
        "6.21",
        include_str!("../../../../data/thesis/table_6_21_scene6_drawing_s.csv"),
    ),
    published("6.22", TABLE_6_22),
    published("6.23", TABLE_6_23),
    published("6.24", TABLE_6_24),
    published(
        "7.1",
        include_str!("../../../../data/thesis/table_7_1_converter_sizes.csv"),
    ),
    published(
        "text",
        include_str!("../../../../data/thesis/figures_in_text.csv"),
    ),
];

const fn published(number: &'static str, csv: &'static str) -> PublishedTable {
    PublishedTable { number, csv }
}

impl PublishedTable {
    /// The table of that number.
    pub fn find(number: &str) -> Option<&'static Self> {
        PUBLISHED_TABLES.iter().find(|table| table.number == number)
    }

    /// The names of its columns, the first of which names the rows.
    pub fn heading(&self) -> Vec<&'static str> {
        let first = self.csv.lines().next().unwrap_or_default();
        first.split(',').collect()
    }

    /// Its rows: as many cells in each as in the heading.
    pub fn rows(&self) -> Vec<Vec<&'static str>> {
        let mut rows = Vec::new();
        for line in self.csv.lines().skip(1) {
            rows.push(line.split(',').collect());
        }
        rows
    }

    /// The names of its rows, without that of the mean.
    pub fn names(&self) -> Vec<&'static str> {
        let mut names: Vec<&str> = self.rows().iter().map(|row| row[0]).collect();
        names.retain(|name| *name != "average");
        names
    }

    /// The cell of a row in a column, as it is printed.
    pub fn cell(&self, row: &str, column: &str) -> Option<&'static str> {
        let index = self.heading().iter().position(|name| *name == column)?;
        let rows = self.rows();
        let found = rows.iter().find(|cells| cells[0] == row)?;
        found.get(index).copied()
    }

    /// The number in a row and a column.
    pub fn number(&self, row: &str, column: &str) -> Option<f64> {
        self.cell(row, column)?.parse().ok()
    }

    /// The numbers of a column, in the order of [`Self::names`].
    pub fn column(&self, column: &str) -> Vec<Option<f64>> {
        let names = self.names();
        names.iter().map(|row| self.number(row, column)).collect()
    }
}

/// The number in a table's row and column; `None` where the thesis has none.
pub(super) fn published_number(table: &str, row: &str, column: &str) -> Option<f64> {
    PublishedTable::find(table)?.number(row, column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_rectangles_of_numbers_as_printed() {
        for table in PUBLISHED_TABLES {
            let width = table.heading().len();
            assert!(
                width > 1 && !table.rows().is_empty(),
                "table {}",
                table.number
            );
            for row in table.rows() {
                assert_eq!(row.len(), width, "table {}: {row:?}", table.number);
            }
        }
        // Printed means of printed rows, where the thesis has them right: table 6.10's last column.
        let table = PublishedTable::find("6.10").unwrap();
        let column = table.column("n1000000");
        let sum: f64 = column.iter().flatten().sum();
        assert_eq!(column.len(), 16);
        assert!((sum / 16.0 - 22.47).abs() < 0.005, "{}", sum / 16.0);
        assert_eq!(published_number("6.6", "he", "disc_kb"), Some(2407.25));
        assert_eq!(published_number("text", "scene-5", "seconds"), Some(6.11));
        assert_eq!(published_number("6.6", "nickel", "disc_kb"), None);
    }

    #[test]
    fn models_are_called_alike_in_all_tables() {
        let names = PublishedTable::find("6.4").unwrap().names();
        for number in ["6.5", "6.6", "6.9", "6.10", "6.19"] {
            assert_eq!(PublishedTable::find(number).unwrap().names(), names);
        }
    }
}
