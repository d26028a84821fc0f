//! The options of `rumbo new robot` that say what a robot is: those of the table of what is asked.

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use rumbo_experiment::files::new_robot::{ASKED, Asked};

/// What was answered by options.
#[derive(Clone, Debug)]
pub(crate) struct Answers(pub(crate) Vec<(&'static Asked, String)>);

/// Those of the table that are options.
fn options() -> impl Iterator<Item = &'static Asked> {
    ASKED.iter().filter(|asked| asked.is_option())
}

impl Args for Answers {
    fn augment_args(command: Command) -> Command {
        options().fold(command, |command, asked| {
            let arg = Arg::new(asked.key).long(asked.key);
            let unit = asked.range().map_or("NAME", |(.., unit)| unit);
            let arg = arg.value_name(unit).help(asked.about);
            let check = |text: &str| asked.check(text).map(|()| text.to_owned());
            command.arg(arg.value_parser(check).conflicts_with("like"))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Answers {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let answer = |asked: &'static Asked| {
            let text: &String = matches.get_one(asked.key)?;
            Some((asked, text.clone()))
        };
        Ok(Self(options().filter_map(answer).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
