// The grammar of the cspdiag language for editors. That of the compiler is grammars/csp.lark, and rules have the same names
// here; where tree-sitter's conventions or users of trees gain by it, a node stands for several of its rules (`connection`), and
// lists have no node of their own. It accepts a little more: `a < b < c`, for example, which the compiler explains better.

/// <reference types="tree-sitter-cli/dsl" />
// @ts-check

const PRECEDENCE = {
  conditional: 0,
  or: 1,
  and: 2,
  not: 3,
  comparison: 4,
  sum: 5,
  product: 6,
  sign: 7,
  power: 8,
  postfix: 9,
};

const UNIT = /<[A-Za-z0-9\/*^.-]+>/;

/** One or more, with separators in between. */
const separated = (separator, rule) => seq(rule, repeat(seq(separator, rule)));

/** Two or more, with separators in between. */
const chain = (separator, rule) => seq(rule, repeat1(seq(separator, rule)));

module.exports = grammar({
  name: "csp",

  word: ($) => $.identifier,

  extras: ($) => [/[ \t\r\n\f]/, $.comment, $.doc_comment],

  // `2 s` is a duration, but `2 safe` is not, nor is `2` with a name `s` on the next line: a regular expression cannot tell.
  externals: ($) => [$.duration],

  // After the ports of a submodel `offset` may also be the name that the first equation defines.
  conflicts: ($) => [[$.sampling]],

  supertypes: ($) => [$._item, $._declaration, $._equation, $._step, $._event, $._expression],

  rules: {
    source_file: ($) => repeat($._item),

    _item: ($) =>
      choice(
        $.import_file,
        $.import_library,
        $.constant,
        $.tunable,
        $.type_alias,
        $.enum,
        $.struct,
        $.exception,
        $.process,
        $.submodel,
        $.driver,
        $.environment,
        $.assertion,
      ),

    import_file: ($) => seq("import", field("path", $.string)),
    import_library: ($) => seq("import", separated(".", $.identifier)),

    constant: ($) => seq("const", $._typed_value),
    tunable: ($) => seq("parameter", $._typed_value),
    _typed_value: ($) =>
      seq(
        field("name", $.identifier),
        optional(seq(":", field("type", $.type_name))),
        "=",
        field("value", $._expression),
      ),
    type_alias: ($) => seq("type", field("name", $.identifier), "=", field("type", $.type_name)),
    enum: ($) => seq("enum", field("name", $.identifier), "{", separated(",", field("literal", $.identifier)), "}"),
    struct: ($) => seq("struct", field("name", $.identifier), "{", repeat($.field), "}"),
    field: ($) => seq(field("name", $.identifier), ":", field("type", $.type_name)),
    exception: ($) => seq("exception", field("name", $.identifier)),

    process: ($) =>
      seq(
        "process",
        field("name", $.identifier),
        field("parameters", optional($.parameters)),
        repeat($._option),
        "{",
        repeat($.ports),
        optional($.communication_block),
        optional($.composition_block),
        "}",
      ),
    submodel: ($) =>
      seq(
        "submodel",
        field("name", $.identifier),
        field("parameters", optional($.parameters)),
        repeat($._option),
        "{",
        repeat($.ports),
        repeat($._equation),
        "}",
      ),
    driver: ($) =>
      seq(
        "driver",
        field("name", $.identifier),
        field("parameters", optional($.parameters)),
        repeat($._option),
        "{",
        repeat($.ports),
        "}",
      ),
    environment: ($) =>
      seq(
        "environment",
        field("name", $.identifier),
        "for",
        field("process", $.identifier),
        field("arguments", optional($.arguments)),
        repeat(choice($.step, $.on_miss, $.place)),
        "{",
        repeat($._declaration),
        "}",
      ),

    assertion: ($) =>
      seq(
        "assert",
        field("process", $.identifier),
        choice(
          $.deadlock_free,
          $.livelock_free,
          $.terminates,
          $.schedulable,
          $.refines_traces,
          $.refines_failures,
        ),
      ),
    deadlock_free: (_) => seq("deadlock", "free"),
    livelock_free: (_) => seq("livelock", "free"),
    terminates: (_) => "terminates",
    schedulable: (_) => "schedulable",
    refines_traces: ($) => seq("refines", field("specification", $.identifier), optional($.hidden)),
    refines_failures: ($) =>
      seq("refines", field("specification", $.identifier), "in", "failures", optional($.hidden)),
    hidden: ($) => seq("hide", separated(",", $.identifier)),

    parameters: ($) => seq("(", optional(separated(",", $.parameter)), ")"),
    parameter: ($) =>
      seq(
        field("name", $.identifier),
        ":",
        field("type", $.type_name),
        optional(seq("=", field("default", $._expression))),
      ),

    _option: ($) => choice($.external, $.wcet, $.step, $.method),
    external: ($) => seq(field("language", $.identifier), field("target", $.string)),
    wcet: ($) => seq("wcet", $._expression),
    step: ($) => seq("step", $._expression),
    method: ($) => seq("method", "=", $.identifier),
    on_miss: ($) => seq("on", "miss", $.identifier),
    place: ($) => seq("place", field("name", $.identifier), ":", separated(",", $.identifier)),

    type_name: ($) => seq(field("name", $.identifier), field("unit", optional($.unit)), repeat($.dimension)),
    dimension: ($) => seq("[", $._expression, "]"),

    // Ports

    ports: ($) =>
      seq(
        field("direction", choice("in", "out")),
        separated(",", $.port_name),
        ":",
        field("type", $.type_name),
        optional(seq("=", field("default", $._expression))),
        optional(seq("@", $.sampling, optional("immediate"))),
        optional(seq("safe", field("safe", $._expression))),
      ),
    port_name: ($) => seq(field("name", $.identifier), repeat($.dimension)),
    sampling: ($) =>
      seq(field("period", $._expression), optional(seq("offset", field("offset", $._expression)))),

    // The communication diagram

    communication_block: ($) => seq("communication", "{", repeat($._declaration), "}"),

    _declaration: ($) => choice($.instance, $.variable, $.channel, $.connection, $.repeated_declarations),

    instance: ($) =>
      seq(
        field("name", $.reference),
        ":",
        field("definition", $.identifier),
        field("arguments", optional($.arguments)),
      ),
    variable: ($) =>
      seq(
        "var",
        field("name", $.identifier),
        ":",
        field("type", $.type_name),
        optional(seq("=", field("initial", $._expression))),
      ),
    channel: ($) =>
      seq("channel", field("name", $.identifier), ":", field("type", $.type_name), optional($.kind)),
    repeated_declarations: ($) => seq("for", $.replicator, "{", repeat($._declaration), "}"),

    connection: ($) =>
      choice(
        seq($._sources, "->", $._sinks),
        seq($._sources, "->", $.medium, "->", $._sinks),
        seq($._sources, "->", $.end_label),
      ),
    _sources: ($) => separated(",", field("source", $._endpoint)),
    _sinks: ($) => separated(",", field("sink", $._endpoint)),
    _endpoint: ($) => choice($.reference, $.discard),
    discard: (_) => "_",
    medium: ($) =>
      choice(
        seq(field("label", $.reference), optional($.kind)),
        $.kind,
        $.end_label,
        seq(":", field("type", $.type_name), optional($.kind)),
      ),
    end_label: ($) =>
      seq(field("name", $.reference), ":", field("type", $.type_name), optional($.kind)),
    kind: ($) =>
      choice("sync", "broadcast", "any", seq(choice("buffer", "overwrite"), field("capacity", $._expression))),

    reference: ($) =>
      seq(
        field("name", $._name),
        repeat($.index),
        optional(seq(".", field("member", $.identifier), repeat($.index))),
      ),
    index: ($) => seq("[", $._expression, "]"),
    replicator: ($) => seq(field("name", $.identifier), "<", field("count", $._expression)),

    // Words that may be names where the grammar expects them as well; the token that follows decides. `at[0]` is an element.
    _name: ($) => prec(1, choice($.identifier, alias("at", $.identifier), alias("offset", $.identifier))),

    // The composition diagram. An operator chain uses one operator. A prefix form takes the next operand only; `catch` and
    // `interrupt` bind the operand before them more tightly than that.

    composition_block: ($) => seq("composition", "{", $._composition, "}"),

    _composition: ($) =>
      choice(
        $._step,
        $.sequence,
        $.parallel,
        $.prioritized_parallel,
        $.alternative,
        $.prioritized_alternative,
      ),
    sequence: ($) => chain(";", $._step),
    parallel: ($) => chain("||", $._step),
    prioritized_parallel: ($) => chain("||>", $._step),
    alternative: ($) => chain("[]", $._step),
    prioritized_alternative: ($) => chain("[]>", $._step),

    _step: ($) => choice($._handled, $.mu, $.while_do, $.if_step, $.labelled, $.replicated, $.guarded),
    mu: ($) => seq("mu", $._handled, optional(seq("until", field("until", $._expression)))),
    while_do: ($) => seq("while", field("condition", $._expression), "do", $._step),
    // An `else` belongs to the nearest `if`.
    if_step: ($) =>
      prec.right(
        seq(
          "if",
          field("condition", $._expression),
          "then",
          field("then", $._step),
          optional(seq("else", field("else", $._step))),
        ),
      ),
    labelled: ($) => seq(field("label", $._name), ":", $._step),
    replicated: ($) =>
      seq(field("operator", choice("seq", "par", "pripar", "alt", "prialt")), $.replicator, ":", $._step),
    guarded: ($) => seq($.guard, "->", $._step),

    _handled: ($) => choice($._action, $.catch, $.interrupt),
    catch: ($) => seq($._handled, "catch", field("exception", $.identifier), "->", field("handler", $._action)),
    interrupt: ($) => seq($._handled, "interrupt", $.guard, "->", field("handler", $._action)),

    _action: ($) =>
      choice(
        $.run,
        $.read,
        $.write,
        $.assign,
        $.skip,
        $.stop,
        $.wait,
        $.wait_until,
        $.reset,
        $.raise_exception,
        $.group,
      ),
    run: ($) => $.reference,
    read: ($) => seq(field("channel", $._channel_reference), "?", field("target", $.reference)),
    write: ($) => seq(field("channel", $._channel_reference), "!", field("value", $._expression)),
    assign: ($) => seq(field("target", $._channel_reference), ":=", field("value", $._expression)),
    skip: (_) => "skip",
    stop: (_) => "stop",
    wait: ($) => seq("wait", $._expression),
    wait_until: ($) => seq("wait", "until", $._expression),
    reset: ($) => seq("reset", $.reference),
    raise_exception: ($) => seq("raise", field("exception", $.identifier)),
    group: ($) => seq("(", $._composition, ")"),

    guard: ($) => seq(optional(seq("when", field("condition", $._expression), "&")), $._event),
    _event: ($) =>
      choice($.ready_guard, $.input_guard, $.output_guard, $.after_guard, $.at_guard, $.skip_guard),
    ready_guard: ($) => field("channel", $._channel_reference),
    input_guard: ($) => seq(field("channel", $._channel_reference), "?", field("target", $.reference)),
    output_guard: ($) => seq(field("channel", $._channel_reference), "!", field("value", $._expression)),
    after_guard: ($) => seq("after", $._expression),
    at_guard: ($) => seq("at", $._expression),
    skip_guard: (_) => "skip",

    // A port or variable may be named `stop`.
    _channel_reference: ($) => choice($.reference, alias($._reference_named_stop, $.reference)),
    _reference_named_stop: ($) => field("name", alias("stop", $.identifier)),

    // The equations of a submodel

    _equation: ($) => choice($.let, $.state, $.next, $.derivative, $.equation, $.instance),
    let: ($) => seq("let", field("name", $.identifier), "=", field("value", $._expression)),
    state: ($) =>
      seq(
        "state",
        field("name", $.identifier),
        ":",
        field("type", $.type_name),
        "=",
        field("initial", $._expression),
      ),
    next: ($) => seq("next", field("name", $.identifier), "=", field("value", $._expression)),
    derivative: ($) => seq("der", field("name", $.identifier), "=", field("value", $._expression)),
    equation: ($) => seq(field("target", $.reference), "=", field("value", $._expression)),

    // Expressions

    arguments: ($) => seq("(", optional(separated(",", choice($._expression, $.named_argument))), ")"),
    named_argument: ($) => seq(field("name", $.identifier), "=", field("value", $._expression)),

    _expression: ($) =>
      choice(
        $.conditional,
        $.binary,
        $.unary,
        $.call,
        $.member,
        $.indexed,
        $.parenthesized,
        $.array,
        $.number,
        $.quantity,
        $.duration,
        $.string,
        $.true,
        $.false,
        $.identifier,
      ),
    conditional: ($) =>
      prec.right(
        PRECEDENCE.conditional,
        seq(
          "if",
          field("condition", $._expression),
          "then",
          field("then", $._expression),
          "else",
          field("else", $._expression),
        ),
      ),
    binary: ($) => {
      const operation = (operator) =>
        seq(field("left", $._expression), field("operator", operator), field("right", $._expression));
      return choice(
        prec.left(PRECEDENCE.or, operation("or")),
        prec.left(PRECEDENCE.and, operation("and")),
        prec.left(PRECEDENCE.comparison, operation(choice("==", "!=", "<", "<=", ">", ">="))),
        prec.left(PRECEDENCE.sum, operation(choice("+", "-"))),
        prec.left(PRECEDENCE.product, operation(choice("*", "/", "%"))),
        prec.right(PRECEDENCE.power, operation("^")),
      );
    },
    unary: ($) =>
      choice(
        prec(PRECEDENCE.not, seq(field("operator", "not"), field("operand", $._expression))),
        prec(PRECEDENCE.sign, seq(field("operator", "-"), field("operand", $._expression))),
      ),
    call: ($) => prec(PRECEDENCE.postfix, seq(field("function", $.identifier), field("arguments", $.arguments))),
    member: ($) => prec(PRECEDENCE.postfix, seq(field("value", $._expression), ".", field("name", $.identifier))),
    indexed: ($) =>
      prec(PRECEDENCE.postfix, seq(field("value", $._expression), "[", field("index", $._expression), "]")),
    parenthesized: ($) => seq("(", $._expression, ")"),
    array: ($) => seq("[", separated(",", $._expression), "]"),
    quantity: ($) => seq(field("value", $.number), field("unit", alias(token.immediate(UNIT), $.unit))),
    true: (_) => "true",
    false: (_) => "false",

    // Tokens

    identifier: (_) => /[A-Za-z_][A-Za-z0-9_]*/,
    number: (_) => /[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?/,
    string: (_) => /"[^"\r\n]*"/,
    unit: (_) => UNIT,
    // Of equal matches the first rule is taken, so a line of four slashes is a comment.
    doc_comment: (_) => /\/\/\/([^\/\r\n][^\r\n]*)?/,
    comment: (_) => token(choice(/\/\/[^\r\n]*/, /\/\*[^*]*\*+([^\/*][^*]*\*+)*\//)),
  },
});
