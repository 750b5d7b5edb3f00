(process name: (identifier) @name) @definition.class
(submodel name: (identifier) @name) @definition.class
(driver name: (identifier) @name) @definition.class
(environment name: (identifier) @name) @definition.class
(struct name: (identifier) @name) @definition.struct
(enum name: (identifier) @name) @definition.enum
(type_alias name: (identifier) @name) @definition.type
(exception name: (identifier) @name) @definition.type
(constant name: (identifier) @name) @definition.constant
(tunable name: (identifier) @name) @definition.constant

(instance definition: (identifier) @name) @reference.class
(environment process: (identifier) @name) @reference.class
(assertion process: (identifier) @name) @reference.class
(type_name name: (identifier) @name) @reference.type
