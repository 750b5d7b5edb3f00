[
  (source_file)
  (process)
  (submodel)
  (driver)
  (environment)
  (repeated_declarations)
  (replicated)
] @local.scope

(constant name: (identifier) @local.definition.constant)
(tunable name: (identifier) @local.definition.constant)
(enum literal: (identifier) @local.definition.constant)
(type_alias name: (identifier) @local.definition.type)
(enum name: (identifier) @local.definition.type)
(struct name: (identifier) @local.definition.type)
(parameter name: (identifier) @local.definition.parameter)
(port_name name: (identifier) @local.definition.var)
(instance name: (reference name: (identifier) @local.definition.var))
(variable name: (identifier) @local.definition.var)
(channel name: (identifier) @local.definition.var)
(end_label name: (reference name: (identifier) @local.definition.var))
(let name: (identifier) @local.definition.var)
(state name: (identifier) @local.definition.var)
(replicator name: (identifier) @local.definition.var)

(identifier) @local.reference
