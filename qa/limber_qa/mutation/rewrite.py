"""One C++ source with every possible mutant in it, by the functions of tests/mutation/mutants.h."""

import re
from dataclasses import dataclass

import tree_sitter
import tree_sitter_cpp
from tree_sitter import Node

_PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_cpp.language()))


@dataclass(frozen=True)
class Mutant:
    """`line` is where it stands today; file, function, at and to are what it is known by."""

    number: int
    file: str
    function: str
    at: str  # the line, with ⟦ ⟧ around what is changed
    to: str  # what it becomes
    line: int

    @property
    def key(self) -> tuple[str, str, str, str]:
        return (self.file, self.function, self.at, self.to)


# Operator -> functor, and the functors and operators of its mutants
_FUNCTORS = {
    "<": "std::less<>", "<=": "std::less_equal<>", ">": "std::greater<>",
    ">=": "std::greater_equal<>", "==": "std::equal_to<>", "!=": "std::not_equal_to<>",
    "+": "std::plus<>", "-": "std::minus<>", "*": "std::multiplies<>", "/": "std::divides<>",
    "%": "std::modulus<>", "&": "std::bit_and<>", "|": "std::bit_or<>",
    "<<": "limber::mutants::ShiftLeft", ">>": "limber::mutants::ShiftRight",
}  # fmt: skip
_BINARY = {
    "<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"),
    "==": ("!=",), "!=": ("==",), "+": ("-",), "-": ("+",), "*": ("/",), "/": ("*",),
    "%": ("*",), "&": ("|",), "|": ("&",), "<<": (">>",), ">>": ("<<",),
}  # fmt: skip
_ASSIGNMENTS = {
    "+=": ("AddTo", "-="), "-=": ("TakeFrom", "+="), "*=": ("MultiplyBy", "/="),
    "/=": ("DivideBy", "*="), "|=": ("SetBits", "&="), "&=": ("MaskBits", "|="),
}  # fmt: skip

# Evaluated by the compiler, or no code.
_LEFT_ALONE = {
    "comment", "string_literal", "concatenated_string", "raw_string_literal", "char_literal",
    "template_argument_list", "template_parameter_list", "enum_specifier",
    "static_assert_declaration", "array_declarator", "alias_declaration", "attribute_declaration",
    "noexcept", "bitfield_clause", "decltype", "sizeof_expression", "using_declaration",
    "alignas_qualifier", "lambda_capture_specifier", "throw_statement", "type_descriptor",
    "requires_clause", "concept_definition", "catch_clause", "operator_name",
    "preproc_include", "preproc_def", "preproc_function_def", "preproc_call",
}  # fmt: skip
_CONSTANT = re.compile(r"k[A-Z]\w*|\w+::(?:\w+::)*[A-Z][A-Z0-9_]{2,}|\w+::(?:\w+::)*k[A-Z]\w*")
_NUMBER = re.compile(r"(0[xX][0-9a-fA-F']+|[0-9.']+(?:[eE][-+]?\d+)?)([uUlLfF]*)")
_REMOVABLE = ("call_expression", "assignment_expression", "update_expression")
_JUMPS = ("break_statement", "continue_statement", "return_statement")
_DECIDES_ALREADY = {"<", "<=", ">", ">=", "==", "!=", "&&", "||"}


class _Rewriter:
    def __init__(self, source: bytes, file: str, first: int) -> None:
        self.source = source
        self.file = file
        self.next = first
        self.mutants: list[Mutant] = []
        self.function = ""
        self.in_table = False

    # -- texts

    def raw(self, node: Node) -> str:
        return self.source[node.start_byte : node.end_byte].decode()

    def part(self, node: Node, field: str) -> Node:
        """The child that the grammar has under this name in each node of this type."""
        found = node.child_by_field_name(field)
        if found is None:
            raise ValueError(f"{self.file}: no {field} in {self.raw(node)}")
        return found

    def add(self, node: Node, *become: str) -> int:
        """New mutants that change what `node` says; the number of the first."""
        first = self.next
        begin = self.source.rfind(b"\n", 0, node.start_byte) + 1
        end = self.source.find(b"\n", node.end_byte)
        before = self.source[begin : node.start_byte].decode()
        after = self.source[node.end_byte : end if end >= 0 else None].decode().split("//")[0]
        at = " ".join(f"{before}⟦{self.raw(node)}⟧{after}".split())
        for to in become:
            line = node.start_point[0] + 1
            self.mutants.append(Mutant(self.next, self.file, self.function, at, to, line))
            self.next += 1
        return first

    def inside(self, node: Node) -> str:
        """The node with its children rewritten."""
        parts, position = [], node.start_byte
        for child in node.children:
            parts.append(self.source[position : child.start_byte].decode())
            parts.append(self.visit(child))
            position = child.end_byte
        parts.append(self.source[position : node.end_byte].decode())
        return "".join(parts)

    # -- nodes

    def visit(self, node: Node) -> str:
        if node.type in _LEFT_ALONE:
            return self.raw(node)
        method = getattr(self, f"_{node.type}", None)
        return method(node) if method else self.inside(node)

    def _function_definition(self, node: Node) -> str:
        outer, self.function = self.function, self._name_of(node)
        text = self.inside(node)
        self.function = outer
        return text

    def _name_of(self, node: Node) -> str:
        declarator = node.child_by_field_name("declarator")
        while declarator is not None and declarator.type != "function_declarator":
            declarator = declarator.child_by_field_name("declarator") or (
                declarator.named_children[0] if declarator.named_children else None
            )
        name = declarator.child_by_field_name("declarator") if declarator else None
        return self.raw(name) if name else ""

    def _declaration(self, node: Node) -> str:
        text = self.raw(node)
        words = {self.raw(child) for child in node.children if child.type != "init_declarator"}
        if "constexpr" not in words:
            return self.inside(node)
        if "[]" not in text.split("{")[0] or "static" in words:
            return text  # where it is used, it is changed
        self.in_table = True
        text = self.inside(node).replace("constexpr", "const", 1)
        self.in_table = False
        return text

    def _field_declaration(self, node: Node) -> str:
        words = {self.raw(child) for child in node.children}
        declarator = node.child_by_field_name("declarator")
        pure = declarator is not None and "function_declarator" in str(declarator)
        return self.raw(node) if words & {"static", "constexpr"} or pure else self.inside(node)

    def _case_statement(self, node: Node) -> str:
        value = node.child_by_field_name("value")
        if value is None:
            return self.inside(node)
        head = self.source[node.start_byte : value.end_byte].decode()
        rest = [child for child in node.children if child.start_byte >= value.end_byte]
        return head + "".join(
            (" " if child.is_named else "") + self.visit(child) + "\n" for child in rest
        )

    def _if_statement(self, node: Node) -> str:
        if any(child.type == "constexpr" for child in node.children):
            condition = self.part(node, "condition")
            head = self.source[node.start_byte : condition.end_byte].decode()
            rest = [child for child in node.children if child.start_byte >= condition.end_byte]
            return head + " ".join(["", *(self.visit(child) for child in rest)])
        return self.inside(node)

    def _condition_clause(self, node: Node) -> str:
        value = self.part(node, "value")
        of_if = node.parent is not None and node.parent.type == "if_statement"
        if not of_if or value.type == "declaration" or len(node.named_children) > 1:
            return self.inside(node)
        return f"({self._test(value)})"

    def _conditional_expression(self, node: Node) -> str:
        test, yes, no = (
            self.part(node, name) for name in ("condition", "consequence", "alternative")
        )
        return f"({self._test(test)} ? {self.visit(yes)} : {self.visit(no)})"

    def _test(self, node: Node) -> str:
        """A condition; one that is an operator has mutants of its own."""
        if node.type == "unary_expression" or self._operator(node) in _DECIDES_ALREADY:
            return self.visit(node)
        return f"limber::mutants::tested<{self.add(node, 'its opposite')}>({self.visit(node)})"

    def _operator(self, node: Node) -> str:
        operator = node.child_by_field_name("operator")
        return self.raw(operator) if node.type == "binary_expression" and operator else ""

    def _binary_expression(self, node: Node) -> str:
        left, right = self.part(node, "left"), self.part(node, "right")
        operator = self._operator(node)
        if operator in ("&&", "||"):
            word = "and" if operator == "&&" else "or"
            sides = []
            for side in (left, right):
                number = self.add(side, f"left out of {operator}")
                sides.append(f"limber::mutants::side_of_{word}<{number}>({self.visit(side)})")
            return f"({sides[0]} {operator} {sides[1]})"
        others = _BINARY.get(operator, ())
        if operator == "<" and node.parent is not None and node.parent.type == "for_statement":
            others = (">=",)  # one more element may be nobody's memory
        if not others:
            return self.inside(node)
        number = self.add(self.part(node, "operator"), *others)
        functors = ", ".join(_FUNCTORS[each] for each in (operator, *others))
        operands = f"{self.visit(left)}, {self.visit(right)}"
        return f"limber::mutants::Binary<{number}, {functors}>::of({operands})"

    def _unary_expression(self, node: Node) -> str:
        argument = self.part(node, "argument")
        sign = self.raw(self.part(node, "operator"))
        function = {"!": "negated", "-": "minus"}.get(sign)
        if function is None:
            return self.inside(node)
        number = self.add(node, self.raw(argument))
        return f"limber::mutants::{function}<{number}>({self.visit(argument)})"

    def _number_literal(self, node: Node) -> str:
        text = self.raw(node)
        found = _NUMBER.fullmatch(text)
        if not found:
            return text
        digits = found[1].replace("'", "")
        value = float(digits) if digits[:2] not in ("0x", "0X") else int(digits, 16)
        whole = digits.isdigit() or isinstance(value, int)
        if value == 0:
            return self._changed(node, "1")
        return self._changed(node, *(("+ 1", "- 1") if whole else ("* 1.1", "* -1")))

    def _true(self, node: Node) -> str:
        return self._changed(node, "false")

    def _false(self, node: Node) -> str:
        return self._changed(node, "true")

    def _identifier(self, node: Node) -> str:
        parent = node.parent
        declared = parent is not None and parent.child_by_field_name("declarator") == node
        address = parent is not None and parent.type == "pointer_expression"
        text = self.raw(node)
        if declared or address or not _CONSTANT.fullmatch(text) or text.startswith("std::"):
            return text
        return self._changed(node, "the next", "the one before")

    def _qualified_identifier(self, node: Node) -> str:
        return self._identifier(node)

    def _changed(self, node: Node, *become: str) -> str:
        if self.in_table:
            return f"limber::mutants::cell<{self.add(node, become[0])}>({self.raw(node)})"
        two = "true" if len(become) > 1 else "false"
        return f"limber::mutants::constant<{self.add(node, *become)}, {two}>({self.raw(node)})"

    # -- statements

    def _expression_statement(self, node: Node) -> str:
        expression = node.named_children[0] if node.named_children else None
        if expression is None or expression.type not in _REMOVABLE:
            return self.inside(node)
        if self.raw(node).startswith(("spdlog::", "static_cast<void>")):
            return self.raw(node)
        number = self.add(node, "left out")
        return f"{{ if (!limber::mutants::on<{number}>()) {{ {self._statement(expression)}; }} }}"

    def _statement(self, node: Node) -> str:
        operator = node.child_by_field_name("operator")
        found = _ASSIGNMENTS.get(self.raw(operator)) if operator else None
        if node.type != "assignment_expression" or operator is None or not found:
            return self.visit(node)
        left, right = self.part(node, "left"), self.part(node, "right")
        number = self.add(operator, found[1])
        functors = f"limber::mutants::{found[0]}, limber::mutants::{_ASSIGNMENTS[found[1]][0]}"
        operands = f"{self.raw(left)}, {self.visit(right)}"
        return f"limber::mutants::assign<{number}, {functors}>({operands})"

    def _jump(self, node: Node) -> str:
        if len(node.named_children) or not self._is_of_a_loop(node):
            return self.inside(node)
        return f"if (!limber::mutants::on<{self.add(node, 'left out')}>()) {self.raw(node)}"

    _break_statement = _continue_statement = _return_statement = _jump

    def _is_of_a_loop(self, node: Node) -> bool:
        """A break that ends a case is left alone."""
        parent = node.parent
        while node.type == "break_statement" and parent is not None:
            if parent.type == "case_statement":
                return False
            if parent.type in ("for_statement", "for_range_loop", "while_statement"):
                return True
            parent = parent.parent
        return True


def rewrite(source: str, file: str, first: int) -> tuple[str, list[Mutant]]:
    """`file` with all its mutants, numbered from `first` on."""
    text = source.encode()
    rewriter = _Rewriter(text, file, first)
    written = rewriter.visit(_PARSER.parse(text).root_node)
    head = '#include "tests/mutation/mutants.h"\n'
    return head + written, rewriter.mutants
