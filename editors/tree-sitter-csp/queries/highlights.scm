; Of two captures of one node, Neovim and tree-sitter know the first, Helix the second.

[
  "const" "parameter" "type" "enum" "struct" "exception" "process" "submodel" "driver" "environment" "assert"
  "deadlock" "livelock" "free" "refines" "failures" "hide"
  "wcet" "step" "method" "on" "miss" "place" "offset" "immediate" "safe" "in" "out"
  "communication" "composition" "var" "channel" "sync" "broadcast" "any" "buffer" "overwrite"
  "let" "state" "next" "der"
  "wait" "reset" "interrupt" "after" "at" "when" "par" "pripar" "alt" "prialt"
] @keyword

[(terminates) (schedulable) (skip) (skip_guard) (stop)] @keyword

"import" @keyword.import
["if" "then" "else"] @keyword.conditional
["mu" "until" "while" "do" "for" "seq"] @keyword.repeat
["catch" "raise"] @keyword.exception
["and" "or" "not"] @keyword.operator

[
  "->" "?" "!" ":=" ";" "||" "||>" "[]" "[]>" "&" "@" "=" "+" "-" "*" "/" "%" "^" "==" "!=" "<" "<=" ">" ">="
] @operator

["," ":" "."] @punctuation.delimiter
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
(discard) @variable.builtin

; Definitions and their uses

[
  (type_alias name: (identifier) @type)
  (enum name: (identifier) @type)
  (struct name: (identifier) @type)
  (exception name: (identifier) @type)
  (process name: (identifier) @type)
  (submodel name: (identifier) @type)
  (driver name: (identifier) @type)
  (environment name: (identifier) @type)
  (environment process: (identifier) @type)
  (instance definition: (identifier) @type)
  (assertion process: (identifier) @type)
  (refines_traces specification: (identifier) @type)
  (refines_failures specification: (identifier) @type)
  (catch exception: (identifier) @type)
  (raise_exception exception: (identifier) @type)
]

((type_name name: (identifier) @type.builtin)
  (#match? @type.builtin "^(bool|double|float|u?int(8|16|32)|int|time)$"))
((type_name name: (identifier) @type)
  (#not-match? @type "^(bool|double|float|u?int(8|16|32)|int|time)$"))
(unit) @type

(constant name: (identifier) @constant)
(tunable name: (identifier) @constant)
(enum literal: (identifier) @constant)
(import_library (identifier) @module @namespace)
(external language: (identifier) @keyword)
(method (identifier) @constant.builtin)
(on_miss (identifier) @constant.builtin)

; Names

(parameter name: (identifier) @variable.parameter)
(named_argument name: (identifier) @variable.parameter)
(port_name name: (identifier) @variable.member @variable.other.member)
(field name: (identifier) @variable.member @variable.other.member)
(reference member: (identifier) @variable.member @variable.other.member)
(member name: (identifier) @variable.member @variable.other.member)
(instance name: (reference name: (identifier) @variable))
(variable name: (identifier) @variable)
(channel name: (identifier) @variable)
(end_label name: (reference name: (identifier) @variable))
(let name: (identifier) @variable)
(state name: (identifier) @variable)
(replicator name: (identifier) @variable)
(labelled label: (identifier) @label)

((call function: (identifier) @function.builtin)
  (#match? @function.builtin "^(abs|acos|asin|atan|atan2|ceil|convert|cos|exp|floor|limit|log|max|min|round|sign|sin|sqrt|tan)$"))
((call function: (identifier) @function)
  (#not-match? @function "^(abs|acos|asin|atan|atan2|ceil|convert|cos|exp|floor|limit|log|max|min|round|sign|sin|sqrt|tan)$"))

; Values

[(number) (duration)] @number @constant.numeric
[(true) (false)] @constant.builtin
(string) @string
(comment) @comment
(doc_comment) @comment.documentation @comment.block.documentation
