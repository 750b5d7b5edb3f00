; For Neovim with the plug-in nvim-treesitter; helix/indents.scm is for Helix.

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
  (constant)
  (tunable)
  (assertion)
  (let)
  (state)
  (next)
  (derivative)
  (equation)
] @indent.begin

["}" ")"] @indent.branch @indent.end
[(comment) (doc_comment)] @indent.auto
