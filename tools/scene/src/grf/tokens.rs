//! Words, numbers, strings and signs of a GRF file, one after another.

use merlkit::{Error, Result};

/// A piece of the text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    /// Letters, digits, `$` and `_`, of which the first is no digit.
    Word(&'a str),
    /// A finite number.
    Number(f64),
    /// What is between quotes.
    Text(&'a str),
    /// One of `( ) , =`.
    Sign(char),
    /// Nothing more.
    End,
}

impl Token<'_> {
    /// What it is, for messages.
    pub(super) fn describe(self) -> String {
        match self {
            Self::Word(word) => shorten(word),
            Self::Number(number) => number.to_string(),
            Self::Text(text) => format!("\"{}\"", shorten(text)),
            Self::Sign(sign) => sign.to_string(),
            Self::End => "the end of the file".into(),
        }
    }
}

/// Longest piece of a text that a message repeats, in characters.
const SHOWN: usize = 60;

fn shorten(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Reads the tokens of a text. A copy reads on from the same place.
#[derive(Clone, Copy)]
pub(super) struct Tokens<'a> {
    /// The file, for messages.
    name: &'a str,
    rest: &'a str,
    /// Of the next token, from 1.
    line: usize,
    /// Of the token that was read last.
    last_line: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(name: &'a str, text: &'a str) -> Self {
        Self {
            name,
            rest: text,
            line: 1,
            last_line: 1,
        }
    }

    /// The line of the token that was read last.
    pub(super) fn last_line_number(&self) -> usize {
        self.last_line
    }

    /// The next token.
    ///
    /// # Errors
    /// [`Error::Argument`] for a character that begins none, a string without an end, and a number that is not finite.
    pub(super) fn next(&mut self) -> Result<Token<'a>> {
        self.skip_blanks();
        self.last_line = self.line;
        let Some(first) = self.rest.chars().next() else {
            return Ok(Token::End);
        };
        match first {
            '(' | ')' | ',' | '=' => {
                self.rest = &self.rest[1..];
                Ok(Token::Sign(first))
            }
            '"' => self.read_text(),
            '+' | '-' | '.' | '0'..='9' => self.read_number(),
            _ if is_word(first) => {
                let word = self.take_while(is_word);
                Ok(Token::Word(word))
            }
            _ => Err(self.fault(
                format!("the character {first:?} begins nothing"),
                "remove it, or put // before a comment",
            )),
        }
    }

    /// The next token, which is read again afterwards.
    pub(super) fn peek(&self) -> Result<Token<'a>> {
        let mut ahead = *self;
        ahead.next()
    }

    /// The error for something else than was expected.
    pub(super) fn unexpected(&self, expected: &str, found: Token<'_>) -> Error {
        self.fault(
            format!("expected {expected}, found {}", found.describe()),
            "docs/grf.md has the grammar",
        )
    }

    /// An error at the line of the token that was read last.
    pub(super) fn fault(&self, what: impl AsRef<str>, fix: &str) -> Error {
        fault_in_line(self.name, self.last_line, what.as_ref(), fix)
    }

    fn take_while(&mut self, belongs: fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !belongs(c)).unwrap_or(self.rest.len());
        let (taken, rest) = self.rest.split_at(end);
        self.rest = rest;
        taken
    }

    fn skip_blanks(&mut self) {
        loop {
            let blanks = self.take_while(char::is_whitespace);
            self.line += blanks.bytes().filter(|byte| *byte == b'\n').count();
            if !self.rest.starts_with("//") {
                return;
            }
            self.take_while(|c| c != '\n');
        }
    }

    fn read_text(&mut self) -> Result<Token<'a>> {
        let inside = &self.rest[1..];
        let line = inside.lines().next().unwrap_or_default();
        let Some(end) = line.find('"') else {
            return Err(self.fault("a string without an end", "put a quote behind it"));
        };
        self.rest = &inside[end + 1..];
        Ok(Token::Text(&inside[..end]))
    }

    /// A number with an exponent, and with f or d behind it.
    fn read_number(&mut self) -> Result<Token<'a>> {
        let bytes = self.rest.as_bytes();
        let mut end = 1;
        while end < bytes.len() {
            let belongs = match bytes[end] {
                b'0'..=b'9' | b'.' => true,
                b'e' | b'E' => true,
                b'+' | b'-' => matches!(bytes[end - 1], b'e' | b'E'),
                _ => false,
            };
            if !belongs {
                break;
            }
            end += 1;
        }
        let text = &self.rest[..end];
        let number = text.parse().ok().filter(|x: &f64| x.is_finite());
        let Some(number) = number else {
            let what = format!("{} is no finite number", shorten(text));
            return Err(self.fault(what, "write it as 1, 1.5 or 1e-3"));
        };
        if matches!(bytes.get(end), Some(b'f' | b'F' | b'd' | b'D')) {
            end += 1;
        }
        self.rest = &self.rest[end..];
        if self.rest.starts_with(is_word) {
            let what = format!("{text} and a word without a blank between them");
            return Err(self.fault(what, "put a blank between them"));
        }
        Ok(Token::Number(number))
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
}

/// An error that names the file and the line.
pub(super) fn fault_in_line(name: &str, line: usize, what: &str, fix: &str) -> Error {
    Error::argument(format!("{name}, line {line}: {what}"), fix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_words_and_comments_are_told_apart() {
        let text = "kd=.5f // a comment (1\n\"a b.grf\" (1.,-2e-3d) x_1$";
        let mut tokens = Tokens::new("a", text);
        let mut found = Vec::new();
        loop {
            match tokens.next().unwrap() {
                Token::End => break,
                token => found.push(token),
            }
        }
        use Token::{Number, Sign, Text, Word};
        assert_eq!(
            found,
            [
                Word("kd"),
                Sign('='),
                Number(0.5),
                Text("a b.grf"),
                Sign('('),
                Number(1.0),
                Sign(','),
                Number(-2e-3),
                Sign(')'),
                Word("x_1$"),
            ]
        );
        assert_eq!(tokens.last_line_number(), 2);
    }

    #[test]
    fn what_is_no_token_is_refused_with_its_line() {
        for text in [
            "\n#", "\n\"abc", "\n1e999", "\n1.2.3", "\n--1", "\n12abc", "\n-",
        ] {
            let error = Tokens::new("a.grf", text).next().unwrap_err().to_string();
            assert!(error.starts_with("a.grf, line 2"), "{text}: {error}");
        }
    }
}
