//! What goes in as the compiler writes it, and what comes out.

use super::*;

mod registers;

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
        warm: &[],
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

/// A function that saves r12 to r17, since it changes them, and has 20 bytes of variables.
fn with_frame(name: &str, inside: &str) -> String {
    let pushes: String = [12, 13, 14, 15, 16, 17, 28, 29]
        .map(|register| format!("push r{register}\n"))
        .concat();
    let pops: String = [29, 28, 17, 16, 15, 14, 13, 12]
        .map(|register| format!("pop r{register}\n"))
        .concat();
    let changes: String = (12..18)
        .map(|register| format!("lds r{register}, far\n"))
        .collect();
    let moved = "in r0, 63\ncli\nout 62, r29\nout 63, r0\nout 61, r28\n";
    let text = format!(
        "{pushes}in r28, 61\nin r29, 62\nsbiw r28, 20\n{moved}{changes}{inside}\nadiw r28, 20\n{moved}{pops}ret"
    );
    function(name, &text)
}

#[test]
fn a_function_with_a_frame_begins_and_ends_in_code_for_all() {
    let assembly = squeezed(&with_frame("one", "std Y+1, r24")).unwrap();
    let lines = body(&assembly, "one");
    assert_eq!(lines[..2], ["ldi r26, 20", "rcall rumbo_enter_frame_12"]);
    // What it would jump to at its end follows it.
    assert_eq!(lines[8..], ["std Y+1, r24", "adiw r28, 20"]);
    assert!(assembly.contains(".size one, .-one\n.type rumbo_leave_frame_12"));
    let enter = body(&assembly, "rumbo_enter_frame");
    // The way back lies on top of the stack.
    let way_back = ["rumbo_enter_frame_12:", "pop r0", "pop r31", "pop r30"];
    assert_eq!(enter[..4], way_back);
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
        body(&squeezed(&without).unwrap(), "one")
            .contains(&"rcall rumbo_enter_frame_12".to_owned())
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
            (0..64)
                .map(|at| format!("sts at{at}, r24\n"))
                .collect::<String>()
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
    let handler = text.replace("one", "__vector_1").replace("ret", "reti");
    assert_eq!(
        body(&squeezed(&handler).unwrap(), "__vector_1")[0],
        "call far"
    );
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
    // Where cycles count six words are worth it, five are not.
    let hot = text
        .each_ref()
        .map(|it| it.replace("one", "hot_one").replace("two", "hot_two"));
    assert!(squeezed(&hot.concat()).unwrap().contains("rumbo_shared"));
    let short = hot.concat().replace("\tldi r24, 7\n", "");
    assert!(!squeezed(&short).unwrap().contains("rumbo_shared"));
    let cold = text.concat().replace("\tldi r24, 7\n", "");
    assert!(squeezed(&cold).unwrap().contains("rumbo_shared"));
}

#[test]
fn what_two_functions_end_in_is_jumped_to() {
    let text = [("one", 2), ("two", 3), ("three", 4)].map(|(name, register)| {
        function(
            name,
            &format!(
                "push r{register}\nstd Z+1, r24\nout 62, r31\nout 61, r30\nmovw r24, r30\npop r16\nret"
            ),
        )
    });
    let assembly = squeezed(&text.concat()).unwrap();
    // Not between the halves of the stack pointer.
    assert_eq!(body(&assembly, "two"), ["push r3", "rjmp rumbo_shared_0"]);
    assert_eq!(
        body(&assembly, "rumbo_shared_0")[..2],
        ["std Z+1, r24", "out 62, r31"]
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

/// A function that is called from one place only, by a function of which others know.
fn called(inner: &str, outer: &str) -> String {
    let known = function("outer", outer);
    known + &function("inner", inner).replace("\t.globl\tinner\n", "")
}

#[test]
fn what_no_caller_holds_is_not_saved() {
    let inner = "push r15\npush r16\npush r17\nlds r15, far\nlds r16, far\nsts far, r16\nsts far, r15\npop r17\npop r16\npop r15\nret";
    // r17 is not changed, r16 holds nothing of the caller's, r15 does.
    let outer = "push r15\npush r16\nlds r16, far\nlds r15, far2\nmov r24, r16\ncall inner\nsts far, r15\npop r16\npop r15\nret";
    let assembly = squeezed(&called(inner, outer)).unwrap();
    let lines = body(&assembly, "inner");
    assert_eq!(lines[..2], ["push r15", "lds r15, far"]);
    assert_eq!(lines[lines.len() - 2..], ["pop r15", "ret"]);
    // The caller's own caller may hold something in both.
    assert_eq!(body(&assembly, "outer")[..2], ["push r15", "push r16"]);
}

#[test]
fn an_argument_in_a_register_that_is_saved_is_read() {
    // `other` would change r14 while it waits for `inner`.
    let other = "push r14\nlds r14, far\nsts far, r14\npop r14\nret";
    let outer = "call middle\nret";
    let text = called("sts far, r14\nret", outer)
        + &function("middle", "call other\ncall inner\nret").replace("\t.globl\tmiddle\n", "")
        + &function("other", other).replace("\t.globl\tother\n", "");
    let assembly = squeezed(&text).unwrap();
    assert_eq!(body(&assembly, "other")[0], "push r14");
}

#[test]
fn of_two_that_save_a_register_for_a_caller_one_goes_on_doing_so() {
    // `middle` does not change r14 itself.
    let inner = "push r14\nlds r14, far\nsts far, r14\npop r14\nret";
    let outer = "push r14\nlds r14, far2\ncall middle\nsts far, r14\npop r14\nret";
    let middle = "push r14\ncall inner\nsts far, r1\npop r14\nret";
    let middle = function("middle", middle).replace("\t.globl\tmiddle\n", "");
    let assembly = squeezed(&(called(inner, outer) + &middle)).unwrap();
    let saves = |name| body(&assembly, name).contains(&"push r14".to_owned());
    assert!(saves("inner") && !saves("middle"), "{assembly}");
}

#[test]
fn y_moves_once_for_what_is_far_and_keeps_flags_only_for_those_who_ask() {
    let far = "in r0, 63\nadiw r28, 3\nstd Y+63, r17\nsbiw r28, 3\nout 63, r0\nin r0, 63\nadiw r28, 5\nstd Y+63, r16\nsbiw r28, 5\nout 63, r0";
    let lines = body(&squeezed(&with_frame("hot_one", far)).unwrap(), "hot_one");
    let at = lines.iter().position(|line| line == "adiw r28, 6").unwrap();
    // They are arguments, above three bytes of return address.
    let expected = [
        "adiw r28, 6",
        "std Y+61, r17",
        "std Y+63, r16",
        "sbiw r28, 6",
    ];
    assert_eq!(lines[at..at + 4], expected);
    let asked = format!("cpi r24, 1\n{far}\nbreq .LBB0_1\nsts far, r24\n.LBB0_1:");
    let lines = body(
        &squeezed(&with_frame("hot_one", &asked)).unwrap(),
        "hot_one",
    );
    assert!(lines.contains(&"out 63, r0".to_owned()), "{lines:?}");
    assert!(lines.contains(&"std Y+63, r17".to_owned()), "{lines:?}");
}

#[test]
fn what_is_in_a_register_is_not_put_there_again() {
    let text = function(
        "one",
        "movw r30, r24\nstd Z+1, r22\nmovw r26, r30\nst X, r20\nldi r27, 0\nstd Z+2, r27\nmovw r24, r30\nret",
    );
    let expected = [
        "movw r30, r24",
        "std Z+1, r22",
        "st Z, r20",
        "std Z+2, r1",
        "ret",
    ];
    assert_eq!(body(&squeezed(&text).unwrap(), "one"), expected);
    // A common beginning takes Z.
    let saves = "push r15\npush r16\nlds r15, far\nlds r16, far\nsts far, r15\nsts far, r16\npop r16\npop r15\nret";
    let outer = "push r16\npush r17\nmovw r30, r24\nmovw r16, r24\nst Z, r22\ncall inner\nmovw r30, r16\nst Z, r23\npop r17\npop r16\nret";
    let assembly = squeezed(&called(saves, outer)).unwrap();
    let lines = body(&assembly, "outer");
    let call = lines.iter().position(|line| line == "rcall inner").unwrap();
    assert_eq!(lines[call + 1..call + 3], ["movw r30, r24", "st Z, r23"]);
    // Not behind a call that may change it, nor where two ways come together.
    let lost = function(
        "one",
        "movw r16, r24\ncall far\nmovw r24, r16\ncall far\nret",
    );
    assert!(body(&squeezed(&lost).unwrap(), "one").contains(&"movw r24, r16".to_owned()));
    let ways = function(
        "one",
        "cpi r22, 1\nbreq .LBB0_1\nmov r25, r24\n.LBB0_1:\nmov r24, r25\nret",
    );
    assert_eq!(body(&squeezed(&ways).unwrap(), "one").len(), 6);
}

#[test]
fn what_has_just_been_calculated_is_not_compared_with_zero() {
    let one = |branch: &str| {
        let text =
            format!("andi r24, 1\ncpi r24, 0\n{branch} .LBB0_1\nsts far, r24\n.LBB0_1:\nret");
        body(&squeezed(&function("one", &text)).unwrap(), "one")
    };
    assert_eq!(one("breq")[..2], ["andi r24, 1", "breq .LBB0_1"]);
    // `andi` leaves the carry as it is.
    assert_eq!(one("brlo")[..2], ["andi r24, 1", "cpi r24, 0"]);
}

#[test]
fn functions_that_do_the_same_are_one() {
    let text = function("one", "cpi r24, 1\nbreq .LBB0_1\ninc r24\n.LBB0_1:\nret")
        + &function("two", "cpi r24, 1\nbreq .LBB1_1\ninc r24\n.LBB1_1:\nret")
        + &function("three", "call two\nret")
        + &function("four", "call three\nsts far, r24\nret");
    let assembly = squeezed(&text).unwrap();
    assert_eq!(assembly.matches("inc r24").count(), 1);
    assert!(assembly.contains("two:") && assembly.contains("three:"));
    assert_eq!(body(&assembly, "four")[0], "rcall one");
}

#[test]
fn a_sequence_may_jump_within_itself_but_not_return_for_others() {
    let three = |alike: &str| {
        let text = [("one", 2), ("two", 3), ("three", 4)].map(|(name, register)| {
            let alike = alike.replace(".L", &format!(".LBB{register}_"));
            function(
                name,
                &format!("ldi r24, 7\n{alike}\nsts far, r{register}\nret"),
            )
        });
        squeezed(&text.concat()).unwrap()
    };
    let assembly = three("ldd r22, Z+2\ntst r22\nbreq .L1\nstd Z+3, r22\nstd Z+4, r22\n.L1:");
    let shared = body(&assembly, "rumbo_shared_0");
    assert_eq!(
        shared[2..],
        [
            "tst r22",
            "breq .Lrumbo_shared_0_0",
            "std Z+3, r22",
            "std Z+4, r22",
            ".Lrumbo_shared_0_0:",
            "ret"
        ]
    );
    // A return in it would come back to the caller.
    let assembly = three("ldd r22, Z+2\ntst r22\nbreq .L1\nstd Z+3, r22\nret\n.L1:\nstd Z+4, r22");
    assert!(!assembly.contains("breq .Lrumbo_shared"), "{assembly}");
}
