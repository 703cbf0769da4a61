"""What was found and whether it is right: `explain` and `check`.

    findings    the facts of a derivative as a frozen table
    sizes       the bytes of what is recorded, for given arguments
    explain     the table as text, JSON and a page (page: the HTML)
    check       tangent against adjoint, tangent against differences; parting: where they part first
"""
