//! When a student sees what a line of the rubric earned.

use crate::files::read::{Placed, Table};

/// When a student sees a line of the rubric on Gradescope.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Visibility {
    /// At once.
    #[default]
    Visible,
    /// When hand-ins are due.
    AfterDueDate,
    /// When the marks are published.
    AfterPublished,
    /// Never.
    Hidden,
}

impl Visibility {
    const ALL: [Self; 4] = [
        Self::Visible,
        Self::AfterDueDate,
        Self::AfterPublished,
        Self::Hidden,
    ];

    /// As Gradescope and the file write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Visible => "visible",
            Self::AfterDueDate => "after_due_date",
            Self::AfterPublished => "after_published",
            Self::Hidden => "hidden",
        }
    }

    /// What a table says, if it says it.
    pub(super) fn read(table: &Table<'_, '_>) -> Option<Self> {
        let Placed { value, line } = table.text("visibility")?;
        let found = Self::ALL.into_iter().find(|one| one.name() == value);
        if found.is_none() {
            let names = Self::ALL.map(Self::name).join(", ");
            table.complain(
                "visibility",
                line,
                &value,
                &format!("must be one of {names}"),
            );
        }
        found
    }
}
