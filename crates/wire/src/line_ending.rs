//! What ends a line that a person types.

/// What is sent behind a typed line, as the Serial Monitor of the Arduino IDE offers it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineEnding {
    /// Nothing: single letters are possible.
    None,
    /// Line feed.
    #[default]
    Lf,
    /// Carriage return.
    Cr,
    /// Both, carriage return first.
    CrLf,
}

impl LineEnding {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::None, Self::Lf, Self::Cr, Self::CrLf];

    /// Its name in files, options and orders.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Lf => "lf",
            Self::Cr => "cr",
            Self::CrLf => "crlf",
        }
    }

    /// The one of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|ending| ending.name() == name)
    }

    /// What is sent.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Lf => "\n",
            Self::Cr => "\r",
            Self::CrLf => "\r\n",
        }
    }

    /// A line as it is sent: `\x05` in it is that byte, for robots that are driven by numbers.
    pub fn typed(self, text: &str) -> impl Iterator<Item = u8> + '_ {
        let digit = |byte: u8| char::from(byte).to_digit(16);
        let mut rest = text.as_bytes();
        let letters = core::iter::from_fn(move || {
            if let [b'\\', b'x', high, low, after @ ..] = rest
                && let (Some(high), Some(low)) = (digit(*high), digit(*low))
            {
                rest = after;
                return Some((high << 4 | low) as u8);
            }
            let (first, after) = rest.split_first()?;
            rest = after;
            Some(*first)
        });
        letters.chain(self.text().bytes())
    }
}
