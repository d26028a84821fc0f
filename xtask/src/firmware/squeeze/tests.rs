//! What goes in as the compiler writes it, and what comes out.

use super::*;

/// A function as the compiler writes it.
fn function(name: &str, body: &str) -> String {
    let lines: String = body
        .lines()
        .map(|line| format!("\t{}\n", line.trim()))
        .collect();
    let lines = lines.replace("\t.LBB", ".LBB");
    format!(
        "\t.section\t.text.{name},\"ax\",@progbits\n\t.globl\t{name}\n\t.p2align\t1\n\t.type\t{name},@function\n{name}:\n{lines}.Lfunc_end0:\n\t.size\t{name}, .Lfunc_end0-{name}\n"
    )
}

fn squeezed(text: &str) -> Result<String, String> {
    let options = Options {
        repair: true,
        hot: &["hot".to_owned()],
    };
    squeeze(text, &options).map(|squeezed| squeezed.assembly)
}

/// The instructions and labels of a function in what comes out.
fn body(assembly: &str, name: &str) -> Vec<String> {
    let lines = assembly
        .lines()
        .skip_while(|line| *line != format!("{name}:"))
        .skip(1);
    let lines = lines.take_while(|line| !line.trim().starts_with(".size"));
    lines.map(|line| line.trim().to_owned()).collect()
}

/// A function that saves r12 to r17 and has 20 bytes of variables.
fn with_frame(name: &str, inside: &str) -> String {
    let pushes: String = [12, 13, 14, 15, 16, 17, 28, 29]
        .map(|register| format!("push r{register}\n"))
        .concat();
    let pops: String = [29, 28, 17, 16, 15, 14, 13, 12]
        .map(|register| format!("pop r{register}\n"))
        .concat();
    let moved = "in r0, 63\ncli\nout 62, r29\nout 63, r0\nout 61, r28\n";
    let text = format!(
        "{pushes}in r28, 61\nin r29, 62\nsbiw r28, 20\n{moved}{inside}\nadiw r28, 20\n{moved}{pops}ret"
    );
    function(name, &text)
}

#[test]
fn a_function_with_a_frame_begins_and_ends_in_code_for_all() {
    let assembly = squeezed(&with_frame("one", "std Y+1, r24")).unwrap();
    let expected = [
        "ldi r26, 20",
        "ldi r30, lo8(pm(.Lbody_0))",
        "ldi r31, hi8(pm(.Lbody_0))",
        "rjmp rumbo_enter_frame_12",
        ".Lbody_0:",
        "std Y+1, r24",
        "adiw r28, 20",
        "rjmp rumbo_leave_frame_12",
    ];
    assert_eq!(body(&assembly, "one"), expected);
    let enter = body(&assembly, "rumbo_enter_frame_12");
    assert_eq!(
        enter.iter().filter(|line| line.starts_with("push")).count(),
        8
    );
    assert_eq!(enter.last().unwrap(), "ijmp");
    let leave = body(&assembly, "rumbo_leave_frame_12");
    assert_eq!(leave[4..7], ["out 61, r28", "pop r29", "pop r28"]);
    assert_eq!(leave.last().unwrap(), "ret");
}

#[test]
fn where_cycles_count_a_short_function_keeps_its_own() {
    let assembly = squeezed(&with_frame("hot_one", "std Y+1, r24")).unwrap();
    assert_eq!(body(&assembly, "hot_one")[0], "push r12");
    assert!(!assembly.contains("rumbo_enter"));
}

#[test]
fn an_interrupt_handler_stays_as_it_is() {
    let assembly = squeezed(&function(
        "__vector_1",
        "push r0\nin r0, 63\npush r0\npop r0\nout 63, r0\npop r0\nreti",
    ))
    .unwrap();
    assert_eq!(body(&assembly, "__vector_1").len(), 7);
}

#[test]
fn an_argument_on_the_stack_lies_above_three_bytes_of_return_address() {
    // Eight pushed and 20 of variables: the first argument would be at 31.
    let assembly = squeezed(&with_frame("one", "ldd r24, Y+31\nldd r25, Y+30")).unwrap();
    let lines = body(&assembly, "one");
    assert!(lines.contains(&"ldd r24, Y+32".to_owned()), "{lines:?}");
    assert!(lines.contains(&"ldd r25, Y+30".to_owned()), "{lines:?}");
}

#[test]
fn a_far_argument_is_reached_by_moving_y_farther() {
    let assembly = squeezed(&with_frame(
        "one",
        "adiw r28, 8\nldd r24, Y+62\nldd r25, Y+63\nsbiw r28, 8",
    ))
    .unwrap();
    let lines = body(&assembly, "one");
    assert!(lines.contains(&"adiw r28, 9".to_owned()), "{lines:?}");
    assert!(lines.contains(&"sbiw r28, 9".to_owned()), "{lines:?}");
}

#[test]
fn without_gaps_in_what_is_pushed_arguments_would_move() {
    let gap = with_frame("one", "ldd r24, Y+30")
        .replace("\tpush r13\n", "")
        .replace("\tpop r13\n", "");
    assert_eq!(body(&squeezed(&gap).unwrap(), "one")[0], "push r12");
    let without = gap.replace("Y+30", "Y+20");
    assert!(
        body(&squeezed(&without).unwrap(), "one").contains(&"rjmp rumbo_enter_frame_12".to_owned())
    );
}

#[test]
fn a_branch_around_a_jump_goes_there_itself() {
    let text = function(
        "one",
        "cpi r24, 1\nbreq .LBB0_1\nrjmp .LBB0_2\n.LBB0_1:\nldi r24, 2\nret\n.LBB0_2:\nldi r24, 3\nret",
    );
    let lines = body(&squeezed(&text).unwrap(), "one");
    assert_eq!(lines[..3], ["cpi r24, 1", "brne .LBB0_2", "ldi r24, 2"]);
}

#[test]
fn a_branch_that_does_not_reach_goes_around_a_jump() {
    let text = function(
        "hot_one",
        &format!(
            "cpi r24, 1\nbreq .LBB0_2\n{}ret\n.LBB0_2:\nldi r24, 3\nret",
            "nop\n".repeat(64)
        ),
    );
    let lines = body(&squeezed(&text).unwrap(), "hot_one");
    assert_eq!(lines[1..4], ["brne .Lskip_0", "rjmp .LBB0_2", ".Lskip_0:"]);
}

#[test]
fn what_many_call_and_none_reaches_has_an_island() {
    let text = function("one", &format!("{}ret", "call far\n".repeat(3)));
    let assembly = squeezed(&text).unwrap();
    assert_eq!(body(&assembly, "one")[0], "rcall .Lisland_0_0");
    assert!(body(&assembly, "rumbo_island_0").contains(&"jmp far".to_owned()));
    let hot = squeezed(&text.replace("one", "hot_one")).unwrap();
    assert_eq!(body(&hot, "hot_one")[0], "call far");
}

#[test]
fn what_is_not_understood_is_refused() {
    // A branch that becomes two instructions must not follow one that skips the next.
    let skips = [
        "cpse r24, r25",
        "sbrc r24, 1",
        "sbrs r24, 1",
        "sbic 5, 1",
        "sbis 5, 1",
    ];
    for line in skips.into_iter().chain(["icall", "breq .+4", "rjmp 12"]) {
        let error = squeezed(&function("one", &format!("{line}\nret"))).unwrap_err();
        assert!(error.contains(line), "{error}");
    }
    let error = squeezed(&with_frame(
        "one",
        "sbiw r28, 1\nldd r24, Y+62\nadiw r28, 2",
    ))
    .unwrap_err();
    assert!(error.contains("Y moves by"), "{error}");
}

#[test]
fn variables_stay_as_they_are() {
    let data = "\t.type\tTEXT,@object\n\t.section\t.data.TEXT,\"aw\",@progbits\nTEXT:\n\t.ascii\t\"a;b\"\n\t.size\tTEXT, 3\n";
    let text = function("one", "ret") + data;
    let assembly = squeezed(&text).unwrap();
    for line in data.lines() {
        assert!(assembly.contains(line.trim()), "{line}\n{assembly}");
    }
}

#[test]
fn debuggers_know_types_and_where_a_function_begins() {
    let code = function("one", "ret").replace(
        "one:\n",
        "one:\n.Lfunc_begin0:\n\t.loc\t1 7 0 prologue_end\n",
    );
    let text = "\t.file\t1 \"/here\" \"one.rs\"\n".to_owned()
        + &code
        + "\t.section\t.debug_info,\"\",@progbits\n\t.short\t.Lfunc_begin0\n\t.long\t.Ldebug_loc0\n\t.section\t.debug_loc,\"\",@progbits\n.Ldebug_loc0:\n\t.short\t.Ltmp0-.Lfunc_begin0\n";
    let assembly = squeezed(&text).unwrap();
    assert!(assembly.contains(".file\t1 \"/here/one.rs\""), "{assembly}");
    assert_eq!(body(&assembly, "one"), [".loc 1 7", "ret"]);
    // The place of the function is not told, and the list of places has an end and nothing else.
    assert!(
        assembly.contains(".short 0\n.long\t.Ldebug_loc0"),
        "{assembly}"
    );
    assert!(!assembly.contains(".Ltmp0"), "{assembly}");
}

#[test]
fn what_two_functions_do_alike_is_written_once() {
    let alike = "ldd r22, Z+2\nldd r23, Z+3\nstd Y+5, r22\nstd Y+6, r23\ncall far\n";
    let text = [("one", 2), ("two", 3), ("three", 4)].map(|(name, register)| {
        function(name, &format!("ldi r24, 7\n{alike}inc r{register}\nret"))
    });
    let assembly = squeezed(&text.concat()).unwrap();
    assert_eq!(
        body(&assembly, "two"),
        ["rcall rumbo_shared_0", "inc r3", "ret"]
    );
    // It ends in what it would call.
    let shared = body(&assembly, "rumbo_shared_0");
    assert_eq!((shared.len(), shared[5].as_str()), (6, "jmp far"));
    let hot = squeezed(
        &text
            .concat()
            .replace("one", "hot_one")
            .replace("two", "hot_two"),
    )
    .unwrap();
    assert!(!hot.contains("rumbo_shared"), "{hot}");
}

#[test]
fn what_two_functions_end_in_is_jumped_to() {
    let text = [("one", 2), ("two", 3), ("three", 4)].map(|(name, register)| {
        function(
            name,
            &format!(
                "push r{register}\ninc r24\nout 62, r31\nout 61, r30\nmovw r24, r30\npop r16\nret"
            ),
        )
    });
    let assembly = squeezed(&text.concat()).unwrap();
    // Not between the halves of the stack pointer.
    assert_eq!(body(&assembly, "two"), ["push r3", "rjmp rumbo_shared_0"]);
    assert_eq!(
        body(&assembly, "rumbo_shared_0")[..2],
        ["inc r24", "out 62, r31"]
    );
}

#[test]
fn nothing_that_counts_on_the_stack_is_called_from_somewhere_else() {
    let alike = "in r30, 61\nin r31, 62\npush r24\npush r25\npop r20\npop r21\n";
    let text = [("one", 2), ("two", 3), ("three", 4)]
        .map(|(name, register)| function(name, &format!("{alike}inc r{register}\nret")));
    assert!(!squeezed(&text.concat()).unwrap().contains("rumbo_shared"));
    // Nor a call that leaves an argument there.
    let reads = with_frame("reads", "ldd r24, Y+31");
    let calls = [("one", 2), ("two", 3), ("three", 4)].map(|(name, register)| {
        function(
            name,
            &format!("ldi r24, 7\ncall reads\nldi r20, 9\ninc r{register}\nret"),
        )
    });
    assert!(
        !squeezed(&(reads + &calls.concat()))
            .unwrap()
            .contains("rumbo_shared")
    );
}

#[test]
fn where_the_hardware_is_touched_no_time_changes() {
    let alike = "sts 96, r24\nsts 96, r25\nnop\nnop\nnop\n";
    let text = [("one", 2), ("two", 3), ("three", 4)]
        .map(|(name, register)| function(name, &format!("{alike}inc r{register}\nret")));
    assert!(!squeezed(&text.concat()).unwrap().contains("rumbo_shared"));
}
