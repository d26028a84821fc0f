//! What goes through the page's debugger while that holds the program.

use super::SimulatedRobot;
use crate::in_hand::InHand;
use rumbo_session::{LinkNews, TargetError};
use rumbo_sim::Sim;
use serde_json::Value;

impl SimulatedRobot {
    /// Acts on the simulation, also where a debugger holds it.
    pub(crate) fn act<T: Default>(&mut self, act: impl FnOnce(&mut Sim) -> T) -> T {
        let Some(in_hand) = &mut self.in_hand else {
            return self.sim(act);
        };
        let done = in_hand.act(act).unwrap_or_default();
        self.look();
        done
    }

    /// Copies what the debugger holds.
    pub(crate) fn look(&mut self) {
        if let Some(sim) = self.in_hand.as_ref().and_then(InHand::sim) {
            self.sim(|own| own.clone_from(sim));
        }
    }

    /// A request of a page to the debugger; after `disconnect` the program starts again without it.
    pub(crate) fn pass_to_debugger(&mut self, request: &Value) -> Result<(), TargetError> {
        let in_hand = self.in_hand.as_mut().ok_or(TargetError::NotDebugged)?;
        if request["command"] == "disconnect" {
            let again = self.start_again(&self.choice());
            again.map_err(|error| TargetError::Setup(error.to_string()))?;
            self.news.push_back(LinkNews::Renewed);
            return Ok(());
        }
        in_hand.ask(request)?;
        self.look();
        Ok(())
    }
}
