//! Wrong input whose message is judged by what is in it; the rest is in `refused`.

use crate::support::{file, rumbo, stderr};

#[test]
fn a_file_that_is_all_one_line_is_not_shown_whole() {
    let header = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b ";
    file(
        "one_line.csv",
        &(header.to_owned() + &"69,107,107,30,1,115,115 ".repeat(1_000)),
    );
    let output = rumbo(&["import", "one_line.csv"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("is no header of the original program"),
        "{said}"
    );
    assert!(said.len() < 500, "{}", said.len());
}

#[test]
fn the_node_of_ros_is_named_with_the_program_that_is_it() {
    let output = rumbo(&["ros", "lab"]);
    let said = stderr(&output);
    assert!(
        said.starts_with("error: ros: ") && said.contains("rumbo-ros"),
        "{said}"
    );
    assert_eq!(output.status.code(), Some(2));
}
