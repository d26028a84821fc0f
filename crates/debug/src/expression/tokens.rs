//! The words of an expression: numbers, names, signs.

use crate::value::Number;

/// A word of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(Number),
    Name(String),
    Sign(&'static str),
}

impl Token {
    pub(super) fn text(&self) -> String {
        match self {
            Token::Number(Number::Integer(value)) => value.to_string(),
            Token::Number(Number::Real(value)) => value.to_string(),
            Token::Name(name) => name.clone(),
            Token::Sign(sign) => (*sign).into(),
        }
    }
}

/// Signs, the longer ones first.
const SIGNS: [&str; 27] = [
    "->", "||", "&&", "==", "!=", "<=", ">=", "<<", ">>", "(", ")", "[", "]", ".", "+", "-", "*",
    "/", "%", "&", "|", "^", "~", "!", "<", ">", "::",
];

/// The words of a text; `Err` says what is none.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut tokens = Vec::new();
    let mut rest = text.trim();
    while let Some(first) = rest.chars().next() {
        let is_name = |letter: char| letter.is_alphanumeric() || "_$".contains(letter);
        let taken = if first.is_ascii_digit() {
            let end = rest
                .find(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '.'))
                .unwrap_or(rest.len());
            tokens.push(Token::Number(
                parsed(&rest[..end]).ok_or_else(|| format!("{}: no number", &rest[..end]))?,
            ));
            end
        } else if is_name(first) {
            let mut end = rest.find(|letter| !is_name(letter)).unwrap_or(rest.len());
            while let Some(more) = rest[end..].strip_prefix("::") {
                end += 2 + more.find(|letter| !is_name(letter)).unwrap_or(more.len());
            }
            tokens.push(match &rest[..end] {
                "true" => Token::Number(Number::Integer(1)),
                "false" | "NULL" | "nullptr" => Token::Number(Number::Integer(0)),
                name => Token::Name(name.into()),
            });
            end
        } else if let Some((letter, end)) = character(rest) {
            tokens.push(Token::Number(Number::Integer(letter)));
            end
        } else if let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
            tokens.push(Token::Sign(sign));
            sign.len()
        } else {
            return Err(format!("`{text}`: `{first}` is not understood"));
        };
        rest = rest[taken..].trim_start();
    }
    Ok(tokens)
}

fn parsed(text: &str) -> Option<Number> {
    let plain = text.trim_end_matches(['u', 'U', 'l', 'L']);
    let based = |prefix: &str, base: u32| {
        let digits = plain.strip_prefix(prefix)?;
        i64::from_str_radix(digits, base).ok()
    };
    if let Some(value) = based("0x", 16)
        .or_else(|| based("0b", 2))
        .or_else(|| plain.parse().ok())
    {
        return Some(Number::Integer(value));
    }
    text.trim_end_matches(['f', 'F'])
        .parse()
        .ok()
        .map(Number::Real)
}

/// A character between quotes, and the bytes that it takes.
fn character(text: &str) -> Option<(i64, usize)> {
    let inner = text.strip_prefix('\'')?;
    let (letter, taken) = match inner.strip_prefix('\\') {
        Some(escaped) => {
            let letter = escaped.chars().next()?;
            let value = match letter {
                'n' => '\n',
                'r' => '\r',
                't' => '\t',
                '0' => '\0',
                other => other,
            };
            (value, 1 + letter.len_utf8())
        }
        None => (inner.chars().next()?, inner.chars().next()?.len_utf8()),
    };
    inner[taken..]
        .starts_with('\'')
        .then_some((i64::from(letter as u32), taken + 2))
}
