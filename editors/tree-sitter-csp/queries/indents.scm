; Neovim

[
  (enum)
  (struct)
  (process)
  (submodel)
  (driver)
  (environment)
  (parameters)
  (arguments)
  (communication_block)
  (composition_block)
  (repeated_declarations)
  (group)
] @indent.begin

["}" ")"] @indent.branch @indent.end
[(comment) (doc_comment)] @indent.auto

; Helix

[
  (enum)
  (struct)
  (process)
  (submodel)
  (driver)
  (environment)
  (parameters)
  (arguments)
  (communication_block)
  (composition_block)
  (repeated_declarations)
  (group)
] @indent

["}" ")"] @outdent
