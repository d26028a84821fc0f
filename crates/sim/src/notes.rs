//! Notes: what is said of a robot, a program or a run, by its kind and values. Their English is at hand everywhere; other
//! languages have theirs by the name of the kind.

/// An enum of notes: each kind with its values and its English.
#[macro_export]
macro_rules! notes {
    ($(#[$about:meta])* $Note:ident {
        $($Kind:ident { $($value:ident: $type:ty),* } $english:literal;)*
    }) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq)]
        #[allow(missing_docs, reason = "its English says what a kind is")]
        pub enum $Note {
            $(#[doc = $english] $Kind { $($value: $type),* },)*
        }

        impl $Note {
            /// The names of all kinds.
            pub const KINDS: &'static [&'static str] = &[$(stringify!($Kind)),*];

            /// The name of its kind.
            pub fn kind(&self) -> &'static str {
                match self {
                    $(Self::$Kind { .. } => stringify!($Kind),)*
                }
            }

            /// The values by their names, as texts.
            pub fn values(&self) -> Vec<(&'static str, String)> {
                match self {
                    $(Self::$Kind { $($value),* } => vec![$((stringify!($value), $value.to_string())),*],)*
                }
            }
        }

        impl std::fmt::Display for $Note {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                match self {
                    $(Self::$Kind { $($value),* } => write!(f, $english),)*
                }
            }
        }
    };
}
