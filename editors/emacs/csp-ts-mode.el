;;; csp-ts-mode.el --- Major mode for the cspdiag language  -*- lexical-binding: t; -*-

;; Package-Requires: ((emacs "29.1"))

;;; Commentary:

;; Highlights, indents and lists definitions with the grammar of editors/tree-sitter-csp, and starts `cspdiag lsp' as the
;; server of Eglot.  docs/editors.md says how to install both.

;;; Code:

(require 'treesit)

(defgroup csp nil
  "The cspdiag language."
  :group 'languages)

(defcustom csp-ts-mode-indent-offset 2
  "Number of columns of a level of indentation."
  :type 'integer
  :safe #'integerp)

(defvar csp-ts-mode--types "\\`\\(?:bool\\|double\\|float\\|time\\|u?int\\(?:8\\|16\\|32\\)\\|int\\)\\'")

(defvar csp-ts-mode--functions
  (concat "\\`"
          (regexp-opt '("abs" "acos" "asin" "atan" "atan2" "ceil" "convert" "cos" "exp" "floor" "limit" "log" "max"
                        "min" "round" "sign" "sin" "sqrt" "tan"))
          "\\'"))

(defvar csp-ts-mode--font-lock-settings
  (treesit-font-lock-rules
   :language 'csp
   :feature 'comment
   '((comment) @font-lock-comment-face
     (doc_comment) @font-lock-doc-face)

   :language 'csp
   :feature 'definition
   '((process name: (identifier) @font-lock-type-face)
     (submodel name: (identifier) @font-lock-type-face)
     (driver name: (identifier) @font-lock-type-face)
     (environment name: (identifier) @font-lock-type-face)
     (type_alias name: (identifier) @font-lock-type-face)
     (enum name: (identifier) @font-lock-type-face)
     (struct name: (identifier) @font-lock-type-face)
     (exception name: (identifier) @font-lock-type-face)
     (constant name: (identifier) @font-lock-constant-face)
     (tunable name: (identifier) @font-lock-constant-face)
     (enum literal: (identifier) @font-lock-constant-face)
     (parameter name: (identifier) @font-lock-variable-name-face)
     (port_name name: (identifier) @font-lock-variable-name-face)
     (field name: (identifier) @font-lock-variable-name-face)
     (instance name: (reference name: (identifier) @font-lock-variable-name-face))
     (variable name: (identifier) @font-lock-variable-name-face)
     (channel name: (identifier) @font-lock-variable-name-face)
     (end_label name: (reference name: (identifier) @font-lock-variable-name-face))
     (let name: (identifier) @font-lock-variable-name-face)
     (state name: (identifier) @font-lock-variable-name-face)
     (replicator name: (identifier) @font-lock-variable-name-face)
     (labelled label: (identifier) @font-lock-constant-face))

   :language 'csp
   :feature 'keyword
   '(["after" "alt" "and" "any" "assert" "at" "broadcast" "buffer" "catch" "channel" "communication" "composition"
      "const" "deadlock" "der" "do" "driver" "else" "enum" "environment" "exception" "failures" "for" "free" "hide"
      "if" "immediate" "import" "in" "interrupt" "let" "livelock" "method" "miss" "mu" "next" "not" "offset" "on" "or"
      "out" "overwrite" "par" "parameter" "prialt" "place" "pripar" "process" "raise" "refines" "reset" "safe" "seq" "state"
      "step" "struct" "submodel" "sync" "then" "type" "until" "var" "wait" "wcet" "when" "while"]
     @font-lock-keyword-face
     [(terminates) (schedulable) (skip) (skip_guard) (stop)] @font-lock-keyword-face)

   :language 'csp
   :feature 'string
   '((string) @font-lock-string-face)

   :language 'csp
   :feature 'type
   `(((type_name name: (identifier) @font-lock-builtin-face)
      (:match ,csp-ts-mode--types @font-lock-builtin-face))
     (type_name name: (identifier) @font-lock-type-face)
     (unit) @font-lock-type-face
     (instance definition: (identifier) @font-lock-type-face)
     (environment process: (identifier) @font-lock-type-face)
     (assertion process: (identifier) @font-lock-type-face)
     (refines_traces specification: (identifier) @font-lock-type-face)
     (refines_failures specification: (identifier) @font-lock-type-face)
     (catch exception: (identifier) @font-lock-type-face)
     (raise_exception exception: (identifier) @font-lock-type-face))

   :language 'csp
   :feature 'constant
   '([(true) (false)] @font-lock-constant-face)

   :language 'csp
   :feature 'number
   '([(number) (duration)] @font-lock-number-face)

   :language 'csp
   :feature 'function
   `(((call function: (identifier) @font-lock-builtin-face)
      (:match ,csp-ts-mode--functions @font-lock-builtin-face))
     (call function: (identifier) @font-lock-function-call-face))

   :language 'csp
   :feature 'property
   '((reference member: (identifier) @font-lock-property-use-face)
     (member name: (identifier) @font-lock-property-use-face)
     (named_argument name: (identifier) @font-lock-property-use-face))

   :language 'csp
   :feature 'operator
   '(["->" "?" "!" ":=" ";" "||" "||>" "[]" "[]>" "&" "@" "=" "+" "-" "*" "/" "%" "^" "==" "!=" "<" "<=" ">" ">="]
     @font-lock-operator-face)))

(defvar csp-ts-mode--indent-rules
  `((csp
     ((node-is "[})]") parent-bol 0)
     ((parent-is "source_file") column-0 0)
     ((parent-is ,(regexp-opt '("enum" "struct" "process" "submodel" "driver" "environment" "parameters" "arguments"
                                "communication_block" "composition_block" "repeated_declarations" "group")
                              'symbols))
      parent-bol csp-ts-mode-indent-offset)
     ((field-is "value") parent-bol csp-ts-mode-indent-offset)
     ((node-is "hidden") parent-bol csp-ts-mode-indent-offset)
     (catch-all parent-bol 0))))

(defun csp-ts-mode--name (node)
  "The name of the definition NODE."
  (treesit-node-text (treesit-node-child-by-field-name node "name") t))

;;;###autoload
(define-derived-mode csp-ts-mode prog-mode "CSP"
  "Major mode for the cspdiag language, with tree-sitter."
  (setq-local comment-start "// ")
  (setq-local comment-end "")
  (setq-local comment-start-skip "//+ *")
  (modify-syntax-entry ?_ "_" csp-ts-mode-syntax-table)
  (modify-syntax-entry ?/ ". 124b" csp-ts-mode-syntax-table)
  (modify-syntax-entry ?* ". 23" csp-ts-mode-syntax-table)
  (modify-syntax-entry ?\n "> b" csp-ts-mode-syntax-table)
  (when (treesit-ready-p 'csp)
    (treesit-parser-create 'csp)
    (setq-local treesit-font-lock-settings csp-ts-mode--font-lock-settings)
    (setq-local treesit-font-lock-feature-list
                '((comment definition) (keyword string type) (constant number function) (property operator)))
    (setq-local treesit-simple-indent-rules csp-ts-mode--indent-rules)
    (setq-local indent-tabs-mode nil)
    (setq-local treesit-defun-type-regexp
                (regexp-opt '("process" "submodel" "driver" "environment" "struct" "enum") 'symbols))
    (setq-local treesit-defun-name-function #'csp-ts-mode--name)
    (setq-local treesit-simple-imenu-settings
                '(("Process" "\\`process\\'" nil csp-ts-mode--name)
                  ("Submodel" "\\`submodel\\'" nil csp-ts-mode--name)
                  ("Environment" "\\`environment\\'" nil csp-ts-mode--name)
                  ("Driver" "\\`driver\\'" nil csp-ts-mode--name)
                  ("Type" "\\`\\(?:enum\\|struct\\|type_alias\\)\\'" nil csp-ts-mode--name)
                  ("Constant" "\\`\\(?:constant\\|tunable\\)\\'" nil csp-ts-mode--name)))
    (treesit-major-mode-setup)))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\.csp\\'" . csp-ts-mode))

(defvar eglot-server-programs)
(with-eval-after-load 'eglot
  (add-to-list 'eglot-server-programs '(csp-ts-mode . ("cspdiag" "lsp"))))

(provide 'csp-ts-mode)

;;; csp-ts-mode.el ends here
