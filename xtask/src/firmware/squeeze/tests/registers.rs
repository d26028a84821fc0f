//! Values change their registers where that leaves out a copy.

use super::{body, function, squeezed};

/// What becomes of it; r26 and r30 are neither arguments nor results.
fn one(inside: &str) -> Vec<String> {
    body(&squeezed(&function("one", inside)).unwrap(), "one")
}

#[test]
fn a_copy_whose_sides_can_be_in_one_register_is_left_out() {
    let lines = one("lds r30, far\nmov r26, r30\ninc r26\nsts far, r26\nret");
    assert_eq!(lines, ["lds r26, far", "inc r26", "sts far, r26", "ret"]);
    let lines = one(
        "lds r30, far\nlds r31, far+1\nmovw r26, r30\nsubi r26, 3\nsbci r27, 0\nsts far, r26\nsts far+1, r27\nret",
    );
    assert_eq!(lines.len(), 7);
    assert!(!lines.iter().any(|line| line.starts_with("movw")));
}

#[test]
fn a_value_that_is_still_read_keeps_its_copy() {
    let both = one("lds r30, far\nmov r26, r30\ninc r26\nsts far, r26\nsts far, r30\nret");
    assert_eq!(both[1], "mov r26, r30");
    // So it is around a loop.
    let again = one(
        "lds r30, far\n.LBB0_1:\nmov r26, r30\ninc r26\nsts far, r26\ncpi r26, 9\nbrne .LBB0_1\nret",
    );
    assert_eq!(again[2], "mov r26, r30");
}

#[test]
fn what_an_instruction_cannot_reach_is_not_put_there() {
    // A call changes r30, and r2 is below those to which a number is added.
    let call = "push r16\nlds r16, far\ncall foreign\nmov r30, r16\nsubi r30, 3\nsts far, r30\npop r16\nret";
    assert!(!one(call).contains(&"mov r30, r16".to_owned()));
    assert!(one(&call.replace("r16", "r2")).contains(&"mov r30, r2".to_owned()));
}

#[test]
fn what_is_stored_is_no_pointer_that_moves_meanwhile() {
    let lines = one("mov r18, r26\nst X+, r18\nst X, r18\nret");
    assert_eq!(lines[1], "st X+, r18");
}
