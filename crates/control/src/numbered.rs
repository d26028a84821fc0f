//! Enums whose variants have numbers, on the link and in the table of parameters: written once, listed and found.

/// Defines an enum, the list of its variants (`ALL`), and the way from a number to one of them (`from_number`).
#[macro_export]
macro_rules! numbered {
    (
        $(#[$about:meta])*
        pub enum $name:ident {
            $( $(#[$what:meta])* $variant:ident = $number:literal, )+
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum $name {
            $( $(#[$what])* $variant = $number, )+
        }

        impl $name {
            /// All of them, by number.
            pub const ALL: [Self; [$( $number ),+].len()] = [ $( Self::$variant ),+ ];

            /// The one with this number.
            pub fn from_number(number: u8) -> Option<Self> {
                Self::ALL.into_iter().find(|one| *one as u8 == number)
            }
        }
    };
}
