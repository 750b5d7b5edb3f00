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
] @indent

["}" ")"] @outdent
